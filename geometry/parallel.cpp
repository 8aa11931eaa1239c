#include "geometry/parallel.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace trueblade {
namespace {

thread_local bool loops_are_serial = false;

}  // namespace

SerialLoops::SerialLoops() : before_(std::exchange(loops_are_serial, true)) {}
SerialLoops::~SerialLoops() {
  loops_are_serial = before_;
}

void parallel_for_blocks(std::size_t count, std::size_t block,
                         const std::function<void(std::size_t begin, std::size_t end)>& fn) {
  const std::size_t blocks = (count + block - 1) / block;
  const auto run_block = [&](std::size_t i) { fn(i * block, std::min(count, (i + 1) * block)); };
  if (loops_are_serial || blocks == 1) {
    for (std::size_t i = 0; i < blocks; ++i) run_block(i);
    return;
  }
  tbb::parallel_for(std::size_t{0}, blocks, run_block);
}

}  // namespace trueblade
