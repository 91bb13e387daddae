/* Ctrl-C: the first one is noted, so that the step is finished and written; the second one ends the program. */
#include <signal.h>

static volatile sig_atomic_t seen = 0;

static void note(int number)
{
  seen = 1;
  signal(number, SIG_DFL);
}

void bezel_watch_interrupts(void)
{
  signal(SIGINT, note);
  signal(SIGTERM, note);
}

int bezel_interrupted(void) { return seen; }
