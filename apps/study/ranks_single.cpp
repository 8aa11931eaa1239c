// Built without MPI: always one process.
#include "apps/study/ranks.h"

#include <cstdlib>

#include "geometry/error.h"

namespace trueblade {

bool knows_mpi() {
  return false;
}

Ranks::Ranks() {
  // Several processes that know nothing of each other would all write the same file.
  if (std::getenv("OMPI_COMM_WORLD_SIZE") || std::getenv("PMI_SIZE"))
    throw InputError("started by mpirun, but this program was built without MPI");
}
Ranks::~Ranks() = default;
void Ranks::coordinate(const NextTrials& next, const TrialFunction& evaluate, const TakeOutcomes& take) {
  run_trials(next, evaluate, take);
}
void Ranks::dismiss() {}
void Ranks::work(const TrialFunction&) {}
void Ranks::abandon(int) {}

}  // namespace trueblade
