// The thread sanitizer of GCC 12 does not follow pthread_mutex_clocklock, with which Fast DDS locks, so that
// all guarded data would seem to race. This library, which is preloaded, calls pthread_mutex_timedlock
// instead, which the sanitizer follows.
#define _GNU_SOURCE
#include <pthread.h>
#include <time.h>

enum { nanoseconds = 1000000000 };

int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock, const struct timespec* until) {
  struct timespec now;
  struct timespec real;
  clock_gettime(clock, &now);
  clock_gettime(CLOCK_REALTIME, &real);
  const long long end = (until->tv_sec - now.tv_sec + real.tv_sec) * (long long)nanoseconds + until->tv_nsec -
                        now.tv_nsec + real.tv_nsec;
  const struct timespec by = {(time_t)(end / nanoseconds), (long)(end % nanoseconds)};
  return pthread_mutex_timedlock(mutex, &by);
}
