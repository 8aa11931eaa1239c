#include "hardware/linuxcnc/rsh_client.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "hardware/machine_driver.h"

namespace trueblade {
namespace {

using Kind = RshReply::Kind;

// Lines that are no reply (echoes, noise) may stand between request and reply, but not without end.
constexpr int kMostStrayLines = 16;
// Messages that the controller may hold back for the operator.
constexpr int kMostMessages = 64;

MachineFault protocol_fault(const std::string& request, const std::string& what) {
  return MachineFault(MachineFault::Kind::protocol,
                      fmt::format("linuxcncrsh: the answer to \"{}\" {}", request, what));
}

}  // namespace

RshClient::RshClient(const RshAccess& access, std::function<void()> while_waiting)
    : access_(access),
      while_waiting_(std::move(while_waiting)),
      connection_(access.host, access.port, access.timeout_s) {
  send(fmt::format("hello {} trueblade 1.0", access_.connect_password));
  const RshReply hello = next_reply("hello");
  if (hello.kind == Kind::hello_refused)
    throw MachineFault(MachineFault::Kind::connection, "linuxcncrsh refused the connect password");
  if (hello.kind != Kind::hello_accepted) throw protocol_fault("hello", "is no greeting");
  send("set echo off");
  if (!set("verbose on")) throw protocol_fault("set verbose on", "is a refusal");
  send(fmt::format("set enable {}", access_.enable_password));
  const RshReply enabled = next_reply("set enable");
  if (enabled.kind == Kind::set_refused && enabled.name == "enable")
    throw MachineFault(MachineFault::Kind::connection, "linuxcncrsh refused the enable password");
  if (enabled.kind != Kind::set_accepted || enabled.name != "enable")
    throw protocol_fault("set enable", "answers something else");
  if (!set("set_wait received")) throw protocol_fault("set set_wait received", "is a refusal");
}

void RshClient::send(const std::string& line) {
  connection_.send_all(line + "\r\n", access_.timeout_s);
}

RshReply RshClient::next_reply(const std::string& request) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  for (int stray = 0; stray < kMostStrayLines;) {
    if (const auto line = reader_.next()) {
      const RshReply reply = parse_rsh_reply(*line);
      if (reply.kind != Kind::unrecognised) return reply;
      ++stray;
      continue;
    }
    const double left_s = access_.timeout_s - std::chrono::duration<double>(Clock::now() - start).count();
    if (left_s <= 0.0)
      throw MachineFault(
          MachineFault::Kind::connection,
          fmt::format("linuxcncrsh: no answer to \"{}\" within {} s", request, access_.timeout_s));
    while_waiting_();
    reader_.feed(connection_.receive(std::min(left_s, kCallIntervalS)));
  }
  throw protocol_fault(request, "is lost among lines that are no answers");
}

bool RshClient::set(const std::string& command) {
  const std::string name = command.substr(0, command.find(' '));
  send("set " + command);
  const RshReply reply = next_reply("set " + command);
  const bool answers = reply.kind == Kind::set_accepted || reply.kind == Kind::set_refused;
  if (!answers || reply.name != name)
    throw protocol_fault("set " + command, fmt::format("is about something else (\"{}\")", reply.name));
  return reply.kind == Kind::set_accepted;
}

RshReply RshClient::get(const std::string& name) {
  send("get " + name);
  RshReply reply = next_reply("get " + name);
  if (reply.kind != Kind::value || reply.name != name)
    throw protocol_fault("get " + name, fmt::format("is about something else (\"{}\")", reply.name));
  return reply;
}

std::string RshClient::take_errors() {
  std::string words;
  for (int message = 0; message < kMostMessages; ++message) {
    const RshReply error = get("error");
    if (error.text == "OK" || error.text.empty()) break;
    words += (words.empty() ? "" : "; ") + error.text;
  }
  return words;
}

}  // namespace trueblade
