/* Any bytes whatsoever to the SCIP decoder, with or without the reply to PP that scans need. */
#include "tests/fuzz-decoder.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char parameters[] = "PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nDMIN:20;4\n"
				 "DMAX:5600;_\nARES:1024;\\\nAMIN:44;7\nAMAX:725;o\nAFRT:384;6\n"
				 "SCAN:600;e\n\n";

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	fuzz_decoder("scip", parameters, data, size);
	return 0;
}
