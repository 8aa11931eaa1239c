#include <mpi.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <thread>

#include "apps/study/ranks.h"
#include "geometry/error.h"

namespace trueblade {
namespace {

using namespace std::chrono_literals;

// Worker to rank 0: asks for work, brings outcomes, or words of an error; rank 0 answers a request.
enum Tag : int { kRequest = 1, kOutcomes, kError, kAnswer };

struct Answer {
  enum Kind : std::uint64_t { trials, wait, go_home } kind;
  std::uint64_t begin, end;
};

class ByteWriter {
 public:
  template <class Value>
  void value(const Value& v) {
    const auto* bytes = reinterpret_cast<const char*>(&v);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof v);
  }
  void block(const void* data, std::size_t size) {
    value(static_cast<std::uint64_t>(size));
    const auto* bytes = static_cast<const char*>(data);
    bytes_.insert(bytes_.end(), bytes, bytes + size);
  }
  std::vector<char> bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(const std::vector<char>& bytes) : bytes_(bytes) {}
  bool at_end() const { return at_ == bytes_.size(); }
  template <class Value>
  Value value() {
    Value v;
    std::memcpy(&v, bytes_.data() + at_, sizeof v);
    at_ += sizeof v;
    return v;
  }
  std::string block() {
    const auto size = value<std::uint64_t>();
    std::string text(bytes_.data() + at_, size);
    at_ += size;
    return text;
  }

 private:
  const std::vector<char>& bytes_;
  std::size_t at_ = 0;
};

std::vector<char> packed(const std::vector<Outcome>& outcomes) {
  ByteWriter out;
  for (const Outcome& outcome : outcomes) {
    out.value(outcome.case_number);
    out.value(outcome.trial);
    out.block(outcome.failure.data(), outcome.failure.size());
    out.block(outcome.values.data(), outcome.values.size() * sizeof(double));
  }
  return out.bytes_;
}

std::vector<Outcome> unpacked(const std::vector<char>& bytes) {
  std::vector<Outcome> outcomes;
  ByteReader in(bytes);
  while (!in.at_end()) {
    Outcome outcome;
    outcome.case_number = in.value<std::uint32_t>();
    outcome.trial = in.value<std::uint64_t>();
    outcome.failure = in.block();
    const std::string values = in.block();
    outcome.values.resize(values.size() / sizeof(double));
    std::memcpy(outcome.values.data(), values.data(), values.size());
    outcomes.push_back(std::move(outcome));
  }
  return outcomes;
}

struct Message {
  int source, tag;
  std::vector<char> bytes;
};

// The next message of any rank, if one has come.
std::optional<Message> receive_if_any() {
  int here = 0;
  MPI_Status status;
  // Open MPI looks for a message first and then takes in what has come: the next look finds that.
  for (int look = 0; look < 2 && !here; ++look)
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &here, &status);
  if (!here) return std::nullopt;
  int size = 0;
  MPI_Get_count(&status, MPI_BYTE, &size);
  Message message{status.MPI_SOURCE, status.MPI_TAG, std::vector<char>(static_cast<std::size_t>(size))};
  MPI_Recv(message.bytes.data(), size, MPI_BYTE, message.source, message.tag, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  return message;
}

void send(int to, Tag tag, const void* data, std::size_t size) {
  MPI_Send(data, static_cast<int>(size), MPI_BYTE, to, tag, MPI_COMM_WORLD);
}

void answer(int rank, const Answer& reply) {
  send(rank, kAnswer, &reply, sizeof reply);
}

}  // namespace

bool knows_mpi() {
  return true;
}

Ranks::Ranks() {
  if (!std::getenv("OMPI_COMM_WORLD_SIZE") && !std::getenv("PMI_SIZE") && !std::getenv("PMIX_RANK")) return;
  int level = 0;
  // Threads of one rank take turns to speak.
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &level);
  if (level < MPI_THREAD_SERIALIZED)
    throw InputError("this MPI does not allow threads (MPI_THREAD_SERIALIZED)");
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  MPI_Comm machine;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &on_this_machine_);
  MPI_Comm_free(&machine);
}

Ranks::~Ranks() {
  int started = 0;
  MPI_Initialized(&started);
  if (started) MPI_Finalize();
}

void Ranks::coordinate(const NextTrials& next, const TrialFunction& evaluate, const TakeOutcomes& take) {
  if (size_ == 1) return run_trials(next, evaluate, take);

  // A second thread evaluates here; this one speaks with the other ranks. They share `next` and `take`.
  // After an error no more work is given out, so that the thread comes back with the pieces it has.
  std::mutex mutex;
  std::atomic<bool> stop = false;
  const auto shared_next = [&]() -> std::optional<TrialRange> {
    const std::lock_guard lock(mutex);
    if (stop) return std::nullopt;
    return next();
  };
  const auto shared_take = [&](std::vector<Outcome> outcomes) {
    const std::lock_guard lock(mutex);
    take(std::move(outcomes));
  };
  std::exception_ptr local_error;
  std::atomic<bool> local_done = false;
  std::thread local([&] {
    try {
      run_trials(shared_next, evaluate, shared_take);
    } catch (...) {
      local_error = std::current_exception();
    }
    local_done = true;
  });
  std::exception_ptr remote_error;
  std::size_t pieces_out = 0;
  while (!(local_done && pieces_out == 0) && !remote_error && !(local_done && local_error)) {
    const auto message = receive_if_any();
    if (!message) {
      std::this_thread::sleep_for(500us);
      continue;
    }
    try {
      if (message->tag == kRequest) {
        const auto trials = shared_next();
        if (trials) ++pieces_out;
        answer(message->source,
               trials ? Answer{Answer::trials, trials->begin, trials->end} : Answer{Answer::wait, 0, 0});
      } else if (message->tag == kOutcomes) {
        --pieces_out;
        shared_take(unpacked(message->bytes));
      } else {
        throw InputError(std::string(message->bytes.begin(), message->bytes.end()));
      }
    } catch (...) {
      remote_error = std::current_exception();
      stop = true;
    }
  }
  local.join();
  if (local_error) std::rethrow_exception(local_error);
  if (remote_error) std::rethrow_exception(remote_error);
}

void Ranks::dismiss() {
  for (int at_work = size_ - 1; at_work > 0;) {
    const auto message = receive_if_any();
    if (!message) {
      std::this_thread::sleep_for(500us);
    } else if (message->tag == kRequest) {
      answer(message->source, {Answer::go_home, 0, 0});
      --at_work;
    }
  }
}

void Ranks::work(const TrialFunction& evaluate) {
  std::mutex mutex;
  const auto ask = [&]() -> std::optional<TrialRange> {
    while (true) {
      Answer reply{Answer::go_home, 0, 0};
      {
        const std::lock_guard lock(mutex);
        send(0, kRequest, nullptr, 0);
        MPI_Recv(&reply, sizeof reply, MPI_BYTE, 0, kAnswer, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      }
      if (reply.kind == Answer::trials) return TrialRange{reply.begin, reply.end};
      if (reply.kind == Answer::go_home) return std::nullopt;
      std::this_thread::sleep_for(2ms);
    }
  };
  const auto bring = [&](const std::vector<Outcome>& outcomes) {
    const std::vector<char> bytes = packed(outcomes);
    const std::lock_guard lock(mutex);
    send(0, kOutcomes, bytes.data(), bytes.size());
  };
  try {
    run_trials(ask, evaluate, bring);
  } catch (const std::exception& error) {
    send(0, kError, error.what(), std::strlen(error.what()));
  }
}

void Ranks::abandon(int exit_code) {
  if (size_ > 1) MPI_Abort(MPI_COMM_WORLD, exit_code);
}

}  // namespace trueblade
