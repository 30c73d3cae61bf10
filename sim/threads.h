#ifndef SIM_THREADS_H
#define SIM_THREADS_H
/* For `#pragma omp parallel if (THREADS)`: the thread sanitizer cannot see OpenMP's barriers and
 * would cry wolf. */

#ifdef __SANITIZE_THREAD__
#define THREADS 0
#else
#define THREADS 1
#endif

#endif
