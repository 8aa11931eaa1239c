#include "geometry/parallel.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace trueblade {

void parallel_for_blocks(std::size_t count, std::size_t block,
                         const std::function<void(std::size_t begin, std::size_t end)>& fn) {
  const std::size_t blocks = (count + block - 1) / block;
  tbb::parallel_for(std::size_t{0}, blocks,
                    [&](std::size_t i) { fn(i * block, std::min(count, (i + 1) * block)); });
}

}  // namespace trueblade
