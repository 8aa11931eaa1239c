// Everything that comes from the network or from a torn file, fed with any bytes: lines and replies of
// linuxcncrsh, frames of trueblade-hal and the choice of samples from them, the requests that trueblade-hal
// takes, journals. What is read must also hold together.
//
// With clang (scripts/fuzz.sh) a libFuzzer target; without, a program that runs the files of a corpus.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/error.h"
#include "hardware/bytes.h"
#include "hardware/linuxcnc/driver_request.h"
#include "hardware/linuxcnc/line_reader.h"
#include "hardware/linuxcnc/rsh_reply.h"
#include "hardware/linuxcnc/sample_picker.h"
#include "hardware/linuxcnc/scan_program.h"
#include "hardware/recorded/journal.h"

namespace trueblade {
namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

void read_replies(std::string_view bytes, std::size_t piece) {
  LineReader reader;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    reader.feed(bytes.substr(at, piece));
    while (const auto line = reader.next()) {
      require(!line->empty() && line->size() <= LineReader::kLongestLine);
      const RshReply reply = parse_rsh_reply(*line);
      const auto numbers = numbers_of(reply, reply.words.size());
      require(!numbers || numbers->size() == reply.words.size());
    }
  }
}

void read_frames(std::string_view bytes, std::size_t piece) {
  const std::vector<AxisPositions> path(5);
  SamplePicker picker(path, 3);
  std::size_t picked = 0;
  const auto pick = [&](std::size_t position, const LatchedSample&) {
    require(position == picked++);
    return true;
  };
  FrameReader reader;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    reader.feed(bytes.substr(at, piece));
    while (const auto frame = reader.next()) {
      require(frame_bytes(frame->type, frame->payload).size() >= 11);
      static_cast<void>(greeting_from_payload(frame->payload));
      const auto sample = sample_from_payload(frame->payload);
      if (!sample) continue;
      static_cast<void>(sample_from_payload(sample_payload(*sample)).value());
      try {
        picker.take(*sample, pick);
      } catch (const MachineFault&) {
        return;
      }
    }
  }
  require(picked <= path.size());
}

// The checksum would keep nearly all inputs out: any payload is also tried with its proper frame around it.
void read_payload(std::string_view bytes) {
  const std::string frame =
      frame_bytes(StreamFrame::Type::sample, bytes.substr(0, FrameReader::kLongestPayload));
  read_frames(frame + frame, 7);
}

struct RequestsRead {
  std::vector<DriverRequest> requests;
  std::string_view fault;
};

RequestsRead requests_in(std::string_view bytes, std::size_t piece) {
  DriverRequestReader reader;
  RequestsRead read;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    reader.feed(bytes.substr(at, piece));
    while (auto request = reader.next()) read.requests.push_back(std::move(*request));
  }
  read.fault = reader.fault();
  return read;
}

// The pieces in which bytes arrive say nothing about what they mean.
RequestsRead read_requests(std::string_view bytes, std::size_t piece) {
  const RequestsRead read = requests_in(bytes, piece);
  const RequestsRead whole = requests_in(bytes, bytes.size() + 1);
  require(read.fault == whole.fault && read.requests.size() == whole.requests.size());
  for (std::size_t k = 0; k < read.requests.size(); ++k) {
    const DriverRequest& request = read.requests[k];
    require(request.kind == whole.requests[k].kind && request.program == whole.requests[k].program);
    require(request.kind == DriverRequest::Kind::program || request.program.empty());
  }
  return read;
}

// Any bytes are also tried as a program with its proper checksum, between two other requests.
void read_program(std::string_view bytes, std::size_t piece) {
  std::string sent =
      "watch\nprogram " + std::to_string(bytes.size()) + " " + std::to_string(crc32_of(bytes)) + "\n";
  sent += bytes;
  const RequestsRead read = read_requests(sent + "hold\n", piece);
  require(read.fault.empty() && read.requests.size() == 3);
  require(read.requests[1].program == bytes && read.requests[2].kind == DriverRequest::Kind::hold);
}

void read_records(std::string_view bytes) {
  try {
    const Journal journal = read_journal_bytes(bytes, "input");
    require(journal.sound_bytes + journal.discarded_bytes == bytes.size());
    for (const JournalledView& view : journal.views) require(view.samples.size() <= view.planned);
  } catch (const InputError&) {
  }
}

}  // namespace
}  // namespace trueblade

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t piece = size == 0 ? 1 : 1 + data[0] % 16;
  trueblade::read_replies(bytes, piece);
  trueblade::read_frames(bytes, piece);
  trueblade::read_payload(bytes);
  trueblade::read_requests(bytes, piece);
  trueblade::read_program(bytes, piece);
  trueblade::read_records(bytes);
  return 0;
}
