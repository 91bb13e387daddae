/* Element routines keep their work arrays on the stack. The main thread's stack may grow to the hard limit while the
   program runs (Linux looks the limit up at each growth), so that volume elements of high degree fit. */
#include <sys/resource.h>

void bezel_raise_stack_limit(void)
{
  struct rlimit limit;

  if (getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur == limit.rlim_max) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_STACK, &limit);
}
