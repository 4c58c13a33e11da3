const a = array<array<array<u32, 65536>, 65536>, 65536>()[0][0][0];
