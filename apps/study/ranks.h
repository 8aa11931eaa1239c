// The processes of a study: one, or, when started by mpirun, several on any number of machines (MPI). Rank 0
// keeps the results and gives out the work; every rank, rank 0 too, evaluates trials. Who evaluates what
// depends on who is free; the results do not.
#pragma once

#include "sim/study/run_trials.h"

namespace trueblade {

class Ranks {
 public:
  Ranks();   // joins the others where mpirun started this process
  ~Ranks();  // waits for them
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  int on_this_machine() const { return on_this_machine_; }

  // Rank 0: evaluates what `next` gives, here and on the other ranks, until it has no more and all is taken
  // in. May be called again. An error on any rank is thrown here.
  void coordinate(const NextTrials& next, const TrialFunction& evaluate, const TakeOutcomes& take);
  // Rank 0, last: sends the others home.
  void dismiss();
  // The other ranks: evaluates what rank 0 gives, until dismissed. Errors go to rank 0.
  void work(const TrialFunction& evaluate);
  // Ends all ranks at once with this exit code: for errors, when the others wait for work.
  void abandon(int exit_code);

 private:
  int rank_ = 0, size_ = 1, on_this_machine_ = 1;
};

// False when the program was built without MPI.
bool knows_mpi();

}  // namespace trueblade
