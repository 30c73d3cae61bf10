/* filter_solid_at(), of blocks in plane c. */
const int SOLID_BLOCK = 4;
BETWEEN(between_blocks, c)

float solid_at(ivec2 p)
{
	ivec2 blocks = (area.xy + SOLID_BLOCK - 1) / SOLID_BLOCK;
	return between_blocks(blocks, (vec2(p) + 0.5) / float(SOLID_BLOCK) - 0.5);
}
