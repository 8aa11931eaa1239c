#include "apps/interrupt.h"

#include <atomic>
#include <csignal>

namespace trueblade {
namespace {

std::atomic<bool> interrupt_seen = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch lock-free atomics only");

extern "C" void note_interrupt(int signal) {
  interrupt_seen = true;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, note_interrupt);
  std::signal(SIGTERM, note_interrupt);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupted() {
  return interrupt_seen;
}

}  // namespace trueblade
