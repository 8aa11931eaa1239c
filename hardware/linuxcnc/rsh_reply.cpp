#include "hardware/linuxcnc/rsh_reply.h"

#include <charconv>
#include <cmath>

namespace trueblade {
namespace {

std::string lower_case(std::string_view word) {
  std::string lower(word);
  for (char& letter : lower)
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  return lower;
}

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  std::string word;
  for (const char letter : line) {
    if (letter != ' ' && letter != '\t') {
      word += letter;
    } else if (!word.empty()) {
      words.push_back(std::move(word));
      word.clear();
    }
  }
  if (!word.empty()) words.push_back(std::move(word));
  return words;
}

}  // namespace

RshReply parse_rsh_reply(std::string_view line) {
  using Kind = RshReply::Kind;
  const std::vector<std::string> words = words_of(line);
  RshReply reply;
  if (words.empty()) return reply;
  const std::string first = lower_case(words[0]);
  const std::string last = lower_case(words.back());
  if (first == "hello") {
    if (words.size() >= 2 && lower_case(words[1]) == "ack") reply.kind = Kind::hello_accepted;
    if (words.size() == 2 && last == "nak") reply.kind = Kind::hello_refused;
    return reply;
  }
  if (first == "set" || first == "get") {
    // "SET MODE ACK", "SET MODE NAK", "GET FOO NAK"; anything else is an echo.
    if (words.size() < 3) return reply;
    reply.name = lower_case(words[1]);
    if (last == "nak") reply.kind = first == "set" ? Kind::set_refused : Kind::get_refused;
    if (last == "ack" && first == "set") reply.kind = Kind::set_accepted;
    return reply;
  }
  if (words[0] == "?") return reply;
  reply.kind = Kind::value;
  reply.name = first;
  reply.words.assign(words.begin() + 1, words.end());
  for (const std::string& word : reply.words) reply.text += (reply.text.empty() ? "" : " ") + word;
  return reply;
}

std::optional<std::vector<double>> numbers_of(const RshReply& value, std::size_t count) {
  if (value.kind != RshReply::Kind::value || value.words.size() < count) return std::nullopt;
  std::vector<double> numbers(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::string& word = value.words[k];
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), numbers[k]);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(numbers[k]))
      return std::nullopt;
  }
  return numbers;
}

}  // namespace trueblade
