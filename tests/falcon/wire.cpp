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
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    const std::size_t first = line.find(','), second = line.find(',', first + 1);
    Event event;
    event.time_s = std::stod(line);
    event.kind = line.substr(first + 1, second - first - 1);
    std::vector<unsigned> bytes = bytes_of(line.substr(second + 1));
    if (event.kind == "in" && bytes.size() >= 2) bytes.erase(bytes.begin(), bytes.begin() + 2);
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
