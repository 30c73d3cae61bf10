#ifndef TESTS_PTX_MADE_H
#define TESTS_PTX_MADE_H
/* Pieces of a PTX file: a scan of 2 x 2 cells is HEAD, a transform and CELLS. */

#define CELLS    "1 2 0.5 0.5\n1.01 2 0.4 0.25\n0 0 0 0.5\n1.03 2.01 0.4 1\n"
#define HEAD     "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
#define IDENTITY "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
#define TURNED   "0 1 0 0\n-1 0 0 0\n0 0 1 0\n500010.25 4000020.5 31.125 1\n"

#endif
