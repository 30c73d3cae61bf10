/* grain_unit(): 64-bit numbers as their low and high halves. */
uvec2 times64(uvec2 x, uvec2 y)
{
	/* By halves: umulExtended is not right everywhere (Mesa 22.3). */
	uint a = x.x & 0xffffu, b = x.x >> 16, c = y.x & 0xffffu, d = y.x >> 16;
	uint low = a * c, middle = a * d + (low >> 16), other = b * c + (middle & 0xffffu);
	uint high = b * d + (middle >> 16) + (other >> 16);
	return uvec2((low & 0xffffu) | other << 16, high + x.x * y.y + x.y * y.x);
}

float unit_of(uint x, uint y, uint seed)
{
	uvec2 add = times64(uvec2(seed, 0u), uvec2(0x7f4a7c15u, 0x9e3779b9u));
	uint carry, low = uaddCarry(x, add.x, carry);
	uvec2 h = times64(uvec2(low, y + add.y + carry), uvec2(0x1ce4e5b9u, 0xbf58476du));
	h.x ^= h.y;
	h = times64(h, uvec2(0x133111ebu, 0x94d049bbu));
	return float(h.y >> 8) / 16777216.0;
}
