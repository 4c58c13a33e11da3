// The same as a uniform: a stage that reads masks, too, has no storage buffer left for it on the
// least of devices.

var<uniform> count: u32;
