#include "tests/falcon/wire.h"

#include <fstream>
#include <sstream>

namespace wire {
namespace {

std::vector<unsigned> bytes_of(const std::string& hex) {
  std::vector<unsigned> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<unsigned>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

/// The newest packet that bytes, come in any pieces with anything between, complete; empty when they complete none.
/// What was before it goes.
std::vector<unsigned> packet_in(std::vector<unsigned>& held) {
  constexpr std::size_t kSize = 16;
  std::vector<unsigned> newest;
  std::size_t at = 0;
  while (at + kSize <= held.size()) {
    const auto first = held.begin() + static_cast<std::ptrdiff_t>(at);
    bool whole = first[0] == '<' && first[kSize - 1] == '>';
    for (std::size_t i = 1; whole && i < 13; ++i) whole = first[static_cast<std::ptrdiff_t>(i)] - 'A' < 16U;
    if (whole) newest.assign(first, first + kSize);
    at += whole ? kSize : 1;
  }
  held.erase(held.begin(), held.begin() + static_cast<std::ptrdiff_t>(at));
  return newest;
}

}  // namespace

std::vector<Event> read(const std::filesystem::path& log) {
  std::ifstream file(log);
  std::stringstream whole;
  whole << file.rdbuf();
  std::string text = whole.str();
  text.resize(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  std::istringstream lines(text);
  std::vector<Event> events;
  std::string line;
  std::vector<unsigned> answers;  // not whole yet
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    const std::size_t first = line.find(','), second = line.find(',', first + 1);
    Event event;
    event.time_s = std::stod(line);
    event.kind = line.substr(first + 1, second - first - 1);
    std::vector<unsigned> bytes = bytes_of(line.substr(second + 1));
    if (event.kind == "unplugged") answers.clear();
    if (event.kind == "in" && bytes.size() >= 2) {
      answers.insert(answers.end(), bytes.begin() + 2, bytes.end());  // behind the modem status
      bytes = packet_in(answers);
    }
    event.packet = bytes.size() == 16 && bytes[0] == '<' && bytes[15] == '>';
    for (std::size_t i = 0; event.packet && i < 3; ++i) {
      const unsigned value = (bytes[1 + 4 * i] - 'A') + ((bytes[2 + 4 * i] - 'A') << 4U) +
                             ((bytes[3 + 4 * i] - 'A') << 8U) + ((bytes[4 + 4 * i] - 'A') << 12U);
      event.values[i] = value < 0x8000U ? static_cast<int>(value) : static_cast<int>(value) - 0x10000;
    }
    if (event.packet) event.flags = bytes[13] - 'A';
    events.push_back(event);
  }
  return events;
}

}  // namespace wire
