/* Sums over a group of 256: what those before a thread have. All of them call it at once. */
shared uint sums[256];

uint before(uint thread, uint own)
{
	sums[thread] = own;
	memoryBarrierShared();
	barrier();
	for (uint far = 1u; far < 256u; far *= 2u) {
		uint add = thread >= far ? sums[thread - far] : 0u;
		memoryBarrierShared();
		barrier();
		sums[thread] += add;
		memoryBarrierShared();
		barrier();
	}
	return sums[thread] - own;
}
