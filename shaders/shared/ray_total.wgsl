// The number of rays of a `Trace` pass.

var<storage, read> count: u32;
