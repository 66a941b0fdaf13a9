// The experience without sight as a whole: a scan becomes a scene, three parts of it are found by buttons alone, an
// outline is followed, the report is read. Judged from what the speech program was given, the contacts, the motors' log
// and the report's words; whoever acts knows none of them but what is announced.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/exploration/speaker.h"
#include "scene/folder/folder.h"
#include "tests/app/program.h"
#include "tests/support/guided_visit.h"

namespace sparsha {
namespace {

using haptics::test::DiscStone;
using haptics::test::Placed;

/// A page as it is read aloud: words in their order, a line for each element, headings with their level before them.
std::vector<std::string> read_aloud(const std::string& page) {
  std::vector<std::string> lines(1);
  bool silent = false;
  const auto next_line = [&] {
    if (!lines.back().empty()) lines.emplace_back();
  };
  for (std::size_t at = page.find("<body"); at < page.size();) {
    if (page[at] != '<') {
      if (!silent && !(page[at] == '\n' && lines.back().empty())) lines.back() += page[at];
      ++at;
      continue;
    }
    const std::size_t end = page.find('>', at);
    if (end == std::string::npos) break;
    const std::string tag = page.substr(at + 1, page.find_first_of(" >", at) - at - 1);
    if (tag == "style" || tag == "script" || tag == "svg") silent = true;
    if (tag == "/style" || tag == "/script" || tag == "/svg") silent = false;
    const bool inside_a_line = tag == "small" || tag == "/small" || tag == "b" || tag == "/b" || tag == "code" ||
                               tag == "/code" || tag == "span" || tag == "/span";
    if (!inside_a_line && !silent) next_line();
    if (tag.size() == 2 && tag[0] == 'h' && tag[1] >= '1' && tag[1] <= '6' && !silent)
      lines.back() += std::string("heading ") + tag[1] + ": ";
    at = end + 1;
  }
  return lines;
}

/// The line after the one that is these words, after the place `from`.
std::string after(const std::vector<std::string>& lines, const std::string& words, std::size_t from = 0) {
  for (std::size_t k = from; k + 1 < lines.size(); ++k)
    if (lines[k] == words) return lines[k + 1];
  return {};
}

std::size_t place_of(const std::vector<std::string>& lines, const std::string& words) {
  return static_cast<std::size_t>(std::find(lines.begin(), lines.end(), words) - lines.begin());
}

/// The first number in some words.
double number_in(const std::string& words) {
  const std::size_t at = words.find_first_of("0123456789");
  return at == std::string::npos ? -1.0 : std::strtod(words.c_str() + at, nullptr);
}

/// A table of numbers with a header line.
std::vector<std::map<std::string, double>> table(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line, word;
  std::getline(in, line);
  std::vector<std::string> names;
  for (std::istringstream head(line); std::getline(head, word, ',');) names.push_back(word);
  std::vector<std::map<std::string, double>> rows;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::size_t k = 0; std::getline(cells, word, ',') && k < names.size(); ++k)
      rows.back()[names[k]] = std::strtod(word.c_str(), nullptr);
  }
  return rows;
}

class Visit : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    old_path_ = std::getenv("PATH");
    fs::create_directory(folder_ / "programs");
    const fs::path program = folder_ / "programs" / "espeak-ng";
    std::ofstream(program) << "#!/bin/sh\necho \"$(cat)\" >> '" << (folder_ / "spoken").string() << "'\n";
    fs::permissions(program, fs::perms::owner_all);
    setenv("PATH", ((folder_ / "programs").string() + ":" + old_path_).c_str(), 1);
  }
  void TearDown() override { setenv("PATH", old_path_.c_str(), 1); }

  /// The scan and its configuration, as a curator writes it.
  void write_scan() {
    std::ofstream scan(folder_ / "stone.xyz");
    for (int j = 0; j <= 400; ++j)
      for (int i = 0; i <= 400; ++i) {
        const double x = 0.0025 * i, y = 0.0025 * j;
        scan << x << " " << y << " " << stone_.height_m(x, y) << "\n";
      }
    std::ofstream config(folder_ / "stone.yaml");
    config << "scans: [{file: stone.xyz, units: m}]\norientation: {look_from: [0, 0, 1], up: [0, 1, 0]}\n"
              "grid: {spacing_mm: 2.5}\nlevels: {window: 101}\ncheck: {samples: 20000}\nspeech: on\ncues: on\n"
              "guide: {path: outline, force_n: "
           << stone_.guide_n << ", speed_mm_per_s: 100}\nparts:\n";
    for (const Placed& part : stone_.parts) {
      const auto& m = part.middle_m;
      config << "  - {name: " << part.say << ", say: " << part.say << ", box_m: [" << m.x() - 0.05 << ", "
             << m.y() - 0.05 << ", " << m.x() + 0.05 << ", " << m.y() + 0.05 << "]}\n";
    }
  }

  [[nodiscard]] bool spoken(const std::string& words) const {
    return haptics::eventually([&] { return text_of(folder_ / "spoken").find(words) != std::string::npos; });
  }

  const DiscStone stone_{};
  std::string old_path_;
};

TEST_F(Visit, FindsThreePartsByButtonsFollowsAnOutlineAndReadsTheReport) {
  write_scan();
  const Outcome built = run("build stone.yaml --out scene --quiet");
  ASSERT_EQ(built.code, 0) << built.err;
  const scene::ScenePointer scene = scene::open_scene(folder_ / "scene");
  scene::SpeechConfig speech;
  app::Speaker speaker(speech, true, {});
  haptics::SessionSummary summary;
  std::vector<haptics::ContactEvent> contacts;
  {
    haptics::test::Visitor visitor(scene, (folder_ / "run.csv").string());
    visitor.hears_words = [&](const haptics::Announcement& words) { speaker.hear(words); };
    haptics::test::visit(visitor, stone_);
    if (HasFatalFailure()) return;
    summary = visitor.leave();
    contacts = visitor.contacts;
  }

  // Speech: newer words interrupt older ones, what was waited for was said to its end or to its interruption.
  for (const Placed& part : stone_.parts) EXPECT_TRUE(spoken(part.say)) << text_of(folder_ / "spoken");
  EXPECT_TRUE(spoken("Guide on"));
  EXPECT_EQ(text_of(folder_ / "spoken").find('{'), std::string::npos);

  // Contacts: each part was touched, and in the order of its buttons.
  std::size_t found = 0;
  for (const haptics::ContactEvent& event : contacts) {
    if (event.kind != haptics::ContactEvent::Kind::touch || found == stone_.parts.size()) continue;
    const Eigen::Vector2d off = Eigen::Vector2d(event.place_m[0], event.place_m[1]) - stone_.parts[found].middle_m;
    if (off.cwiseAbs().maxCoeff() < 0.05) ++found;
  }
  EXPECT_EQ(found, stone_.parts.size());

  // Motors: within the device's force, never a number that is none, and a tick a row.
  const auto rows = table(folder_ / "run.csv");
  EXPECT_EQ(rows.size() + summary.dropped_records, summary.ticks);
  ASSERT_FALSE(rows.empty());
  ASSERT_TRUE(rows.front().contains("commanded_force_x_n")) << "a column of run.csv";
  double strongest_n = 0.0;
  for (const auto& row : rows)
    strongest_n = std::max(strongest_n, std::hypot(row.at("commanded_force_x_n"), row.at("commanded_force_y_n"),
                                                   row.at("commanded_force_z_n")));
  EXPECT_GT(strongest_n, 0.3) << "the stone was felt";
  EXPECT_LE(strongest_n, haptics::DeviceLimits{}.max_force_n + 1e-9);

  // The report, read from its beginning: what it is, the figures, whether something is wrong, then the rest.
  const std::vector<std::string> lines = read_aloud(text_of(folder_ / "scene" / "report.html"));
  const auto report = nlohmann::json::parse(text_of(folder_ / "scene" / "report.json"));
  const std::size_t glance = place_of(lines, "heading 2: At a glance");
  const std::size_t warnings = place_of(lines, "heading 2: Warnings");
  ASSERT_LT(glance, warnings);
  ASSERT_LT(warnings, lines.size());
  EXPECT_EQ(lines.front(), "Skip to the content");
  const auto title = std::find_if(lines.begin(), lines.end(),
                                  [](const std::string& line) { return line.rfind("heading 1: ", 0) == 0; });
  ASSERT_NE(title, lines.end());
  EXPECT_LT(static_cast<std::size_t>(title - lines.begin()), glance);
  EXPECT_NEAR(number_in(after(lines, "Coverage", glance)), 100.0 * report["coverage"].get<double>(), 0.1);
  EXPECT_NEAR(number_in(after(lines, "Completeness", glance)), 100.0 * report["check"]["completeness"].get<double>(),
              0.1);
  if (report["warnings"].empty()) {
    EXPECT_EQ(after(lines, "heading 2: Warnings", glance), "There are no warnings.");
  }
  for (const auto& warning : report["warnings"])
    EXPECT_LT(place_of(lines, warning.get<std::string>()), lines.size()) << warning;
}

}  // namespace
}  // namespace sparsha
