// Parallel loops whose results do not depend on the number of threads. The one place, with parallel.cpp, that
// knows the thread library.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace trueblade {

// Calls fn(begin, end) for the blocks [0, block), [block, 2 block), ... of [0, count), the last one shorter,
// in any order and on any number of threads. Blocks are fixed by `count` and `block` alone. An exception of
// fn is passed on. Precondition: block > 0.
void parallel_for_blocks(std::size_t count, std::size_t block,
                         const std::function<void(std::size_t begin, std::size_t end)>& fn);

// While one lives, the loops of its thread run on that thread alone, block after block: for work that is
// itself one of many in an outer parallel loop. Results do not change, by the rule above.
class SerialLoops {
 public:
  SerialLoops();
  ~SerialLoops();
  SerialLoops(const SerialLoops&) = delete;
  SerialLoops& operator=(const SerialLoops&) = delete;

 private:
  bool before_;
};

// The sum of partial(begin, end) over those blocks, added to `zero` in block order: floating-point addition
// is not associative, so that only a fixed order gives the same bits on any number of threads. Value needs
// +=.
template <class Value, class Partial>
Value ordered_sum(std::size_t count, std::size_t block, const Value& zero, const Partial& partial) {
  std::vector<Value> partials((count + block - 1) / block, zero);
  parallel_for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    partials[begin / block] = partial(begin, end);
  });
  Value sum = zero;
  for (const Value& value : partials) sum += value;
  return sum;
}

}  // namespace trueblade
