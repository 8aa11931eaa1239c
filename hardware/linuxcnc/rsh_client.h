// A session with linuxcncrsh: one request, one reply, each within the time-out.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "hardware/linuxcnc/line_reader.h"
#include "hardware/linuxcnc/rsh_reply.h"
#include "hardware/linuxcnc/tcp_connection.h"

namespace trueblade {

struct RshAccess {
  std::string host = "127.0.0.1";
  std::uint16_t port = 5007;
  std::string connect_password = "EMC";    // linuxcncrsh --connectpw
  std::string enable_password = "EMCTOO";  // linuxcncrsh --enablepw
  double timeout_s = 5.0;                  // of every step
};

// After a fault the session is of no further use: an answer that comes late would be taken for the answer to
// the next request.
class RshClient {
 public:
  // Connects, says hello, and takes control. `while_waiting` is called again and again, at least every
  // kCallIntervalS, as long as an answer is waited for; what it throws ends the wait. Throws MachineFault:
  // connection (nobody there, no answer, a password refused) or protocol (an answer that the protocol does
  // not know).
  static constexpr double kCallIntervalS = 0.02;
  RshClient(const RshAccess& access, std::function<void()> while_waiting);

  // `set <command>`; returns whether it was accepted. The command must be one line.
  bool set(const std::string& command);
  // `get <name>`, as in get("joint_homed"); the reply is a value of that name, anything else throws.
  RshReply get(const std::string& name);
  // The controller's own words about what went wrong since the last call; empty when it has nothing to say.
  std::string take_errors();

 private:
  void send(const std::string& line);
  RshReply next_reply(const std::string& request);

  RshAccess access_;
  std::function<void()> while_waiting_;
  TcpConnection connection_;
  LineReader reader_;
};

}  // namespace trueblade
