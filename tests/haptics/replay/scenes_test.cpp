// Recordings of runs in which the scene changed: kept whole, replayed and traced to the same bits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"
#include "haptics/replay/kept_folder.h"
#include "haptics/replay/recorded_scenes.h"
#include "haptics/replay/replay_trace.h"
#include "haptics/replay/scene_keeper.h"
#include "scene/folder/folder.h"
#include "tests/support/changing_scenes.h"
#include "tests/support/recorded_runs.h"
#include "tests/support/test_folder.h"

namespace sparsha::haptics {
namespace {

namespace fs = std::filesystem;
using scene::ScenePointer;
using sparsha::test::in_folder;
using sparsha::test::record_on;
using sparsha::test::scanned_anew;
using sparsha::test::stone;
using sparsha::test::Table;
using sparsha::test::with_a_soft_part;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::size_t kMost = std::size_t{1} << 30U;

/// Plays `file` on `scene` or on what was kept with it, records that, and counts the fields that are other ones.
long differing_in_replay(const ScenePointer& scene, const fs::path& file, const fs::path& again) {
  const auto session = session_of(scene, file, sparsha::test::options_of(scene, again));
  run_to_the_end(*session);
  return Table(again).differing(Table(file));
}

/// The recording as it was written before there was a column for the scene.
void without_scenes(const fs::path& recording, const fs::path& older) {
  const std::string text = read_file(recording, kMost);
  std::string rows;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    std::string line = text.substr(at, end - at);
    for (int column = 0; column < 2; ++column) line.resize(line.rfind(','));  // guide_z_n, too, came after them
    rows += line + "\n";
    at = end + 1;
  }
  write_file(older, rows);
}

/// The words and the kind of the error that `work` ends with.
std::string error_of(const std::function<void()>& work, ErrorKind kind = ErrorKind::input) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  return "no error";
}

std::string opening(const fs::path& file, scene::Trust trust = scene::Trust::own_folder) {
  return error_of([&] { static_cast<void>(open_kept_scenes(Recording(file), trust)); });
}

/// Two new depth scans and an edit of parts after each scene in a folder.
struct RecordedChanges {
  explicit RecordedChanges(const fs::path& folder) {
    first = in_folder(stone(), folder / "statue");
    const ScenePointer turned = scanned_anew(301, 0.4);
    summary = record_on(first, {with_a_soft_part(first), turned, with_a_soft_part(turned), scanned_anew(251, -0.9)},
                        folder / "run.csv");
  }
  ScenePointer first;
  SessionSummary summary;
};

TEST(ScenesOfARecording, ARunOfTwoNewDepthScansAndTwoEditsIsReplayedToTheLastBit) {
  const test::TestFolder folder;
  const RecordedChanges run(folder);
  const Table live(folder / "run.csv");
  // Every scene was touched, and the invented forces are among what is compared.
  std::vector<int> contacts(6, 0);
  for (std::size_t row = 0; row < live.size(); ++row)
    if (live.at(row, "contact") == "1") ++contacts.at(std::stoul(live.at(row, "scene")));
  for (std::size_t scene = 1; scene <= 5; ++scene) EXPECT_GT(contacts[scene], 20) << "scene " << scene;
  EXPECT_EQ(live.at(0, "scene"), "1");
  EXPECT_EQ(live.at(live.size() - 1, "scene"), "5");
  EXPECT_EQ(live.names().at(live.names().size() - 2), "scene") << "at the end, where older readers look no more";
  EXPECT_EQ(live.names().back(), "guide_z_n");

  // What was edited meanwhile, and what has become of the scene since, changes nothing.
  scene::write_description(*with_a_soft_part(run.first), folder / "statue");
  EXPECT_EQ(differing_in_replay(stone(), folder / "run.csv", folder / "again.csv"), 0);
  fs::remove_all(folder / "statue");
  EXPECT_EQ(differing_in_replay(stone(), folder / "run.csv", folder / "again.csv"), 0);
  // The replay's own recording stands for itself too.
  fs::remove_all(folder / "run.scenes");
  EXPECT_EQ(differing_in_replay(stone(), folder / "again.csv", folder / "third.csv"), 0);
  std::printf("%zu rows of %zu columns, contacts on the scenes: %d %d %d %d %d\n", live.size(), live.names().size(),
              contacts[1], contacts[2], contacts[3], contacts[4], contacts[5]);
}

TEST(ScenesOfARecording, OnTheFirstSceneAloneOtherForcesWouldCome) {
  const test::TestFolder folder;
  const ScenePointer first = stone();
  record_on(first, {with_a_soft_part(first)}, folder / "run.csv");
  without_scenes(folder / "run.csv", folder / "older.csv");  // windows fit, since only parts were edited
  EXPECT_GT(differing_in_replay(first, folder / "older.csv", folder / "again.csv"), 0);
  EXPECT_EQ(differing_in_replay(first, folder / "run.csv", folder / "again.csv"), 0);
}

TEST(ScenesOfARecording, TracedOfflineTheyGiveTheLiveRunsRows) {
  const test::TestFolder folder;
  const RecordedChanges run(folder);
  const Recording recording(folder / "run.csv");
  const auto kept = open_kept_scenes(recording, scene::Trust::own_folder);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->by_number().size(), 5U);
  EXPECT_FALSE(kept->of_another_recording());
  const TraceResult result =
      trace_recording(*kept, recording, kept->first()->description().config.haptics, SolverOptions{});
  write_trace(folder / "trace.csv", result);
  EXPECT_EQ(Table(folder / "run.csv").differing(Table(folder / "trace.csv")), 0);
  EXPECT_EQ(result.summary.below_surface, 0U);
}

TEST(ScenesOfARecording, AnExhibitionGoesToOtherFoldersAndBackAndKeepsEachLayerOnce) {
  const test::TestFolder folder;
  const ScenePointer lotus = in_folder(stone(), folder / "lotus");
  const ScenePointer wheel = in_folder(stone(201, {}, {-1.0, 4.0, 0.0}), folder / "wheel");
  record_on(lotus, {wheel, scene::open_scene(folder / "lotus"), scene::open_scene(folder / "wheel")},
            folder / "run.csv");
  EXPECT_EQ(differing_in_replay(lotus, folder / "run.csv", folder / "again.csv"), 0);
  const fs::path kept = folder / "run.scenes";
  EXPECT_TRUE(fs::equivalent(kept / "1/level-0/height.tif", kept / "3/level-0/height.tif"));
  EXPECT_TRUE(fs::equivalent(kept / "2/level-0/height.tif", kept / "4/level-0/height.tif"));
  EXPECT_FALSE(fs::equivalent(kept / "1/level-0/height.tif", folder / "lotus/level-0/height.tif"));
  EXPECT_FALSE(fs::equivalent(kept / "1/scene.yaml", kept / "3/scene.yaml"));
}

TEST(ScenesOfARecording, WhileItIsPlayedTheSessionShowsAndSaysTheSceneOfTheRow) {
  const test::TestFolder folder;
  const ScenePointer first = stone(201);
  record_on(first, {with_a_soft_part(first), scanned_anew(151, 0.3)}, folder / "run.csv");
  auto session = session_of(first, folder / "run.csv", SessionOptions{});
  std::set<std::size_t> parts_and_nodes;
  session->start();
  while (!session->finished()) {
    session->poll();
    const State now = session->state().read();
    session->poll();  // of that tick or a later one
    const auto& shown = session->scene()->description();
    if (session->state().read().scene == now.scene)
      parts_and_nodes.insert(now.scene * 10000 + shown.config.parts.size() * 1000 +
                             static_cast<std::size_t>(shown.levels.front().nx));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  session->stop();
  EXPECT_EQ(parts_and_nodes, (std::set<std::size_t>{11201, 22201, 31151}));
  const auto all = session->announcements().since(0);
  EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const Announcement& a) { return a.text == "The soft side"; }));
}

TEST(ScenesOfARecording, ARunOfOneSceneKeepsNothingAndIsPlayedOnTheOneThatIsGiven) {
  const test::TestFolder folder;
  const ScenePointer scene = stone(201);
  record_on(scene, {}, folder / "run.csv");
  EXPECT_FALSE(fs::exists(folder / "run.scenes"));
  EXPECT_FALSE(open_kept_scenes(Recording(folder / "run.csv"), scene::Trust::own_folder));
  EXPECT_EQ(differing_in_replay(scene, folder / "run.csv", folder / "again.csv"), 0);
  without_scenes(folder / "run.csv", folder / "older.csv");
  EXPECT_EQ(differing_in_replay(scene, folder / "older.csv", folder / "again.csv"), 0) << "nor do older recordings";
}

TEST(ScenesOfARecording, ARunThatEndsBeforeTheSecondSceneIsTouchedStillHasItsFirst) {
  const test::TestFolder folder;
  const ScenePointer first = stone(201);
  {
    Session session(first, make_simulated_device(4, 0.0), sparsha::test::options_of(first, folder / "run.csv"));
    session.start();
    while (session.state().read().time_s < 1.0) session.poll();
    session.set_scene(with_a_soft_part(first));
    session.stop();
  }
  const Table live(folder / "run.csv");
  ASSERT_EQ(live.at(live.size() - 1, "scene"), "1");
  const auto kept = open_kept_scenes(Recording(folder / "run.csv"), scene::Trust::own_folder);
  ASSERT_TRUE(kept) << "the folder is this recording's, to the byte";
  EXPECT_EQ(kept->first()->description().config.parts.size(), 1U);
  // Of another recording it is not.
  record_on(first, {}, folder / "other.csv");
  fs::rename(folder / "run.scenes", folder / "other.scenes");
  EXPECT_FALSE(open_kept_scenes(Recording(folder / "other.csv"), scene::Trust::own_folder));
}

TEST(ScenesOfARecording, CutRowsLeaveTheRestPlayableAndSayThatTheyWereCut) {
  const test::TestFolder folder;
  const ScenePointer first = stone(201);
  record_on(first, {scanned_anew(151, 0.3)}, folder / "run.csv");
  const std::string text = read_file(folder / "run.csv", kMost);
  const std::size_t head = text.find('\n') + 1;
  std::size_t left = head;  // the tenth row of scene 2
  const Table live(folder / "run.csv");
  for (std::size_t row = 0, of_second = 0; row < live.size() && of_second < 10; ++row) {
    if (live.at(row, "scene") == "2") ++of_second;
    left = text.find('\n', left) + 1;
  }
  write_file(folder / "run.csv", text.substr(0, head) + text.substr(left));
  const auto kept = open_kept_scenes(Recording(folder / "run.csv"), scene::Trust::own_folder);
  ASSERT_TRUE(kept);
  EXPECT_TRUE(kept->of_another_recording());
  const auto session = session_of(first, folder / "run.csv", SessionOptions{});
  EXPECT_EQ(session->scene()->description().levels.front().nx, 151) << "the first row that is left is of scene 2";
  run_to_the_end(*session);
}

TEST(ScenesOfARecording, ASceneThatCouldNotBeReadAndWasNeverTouchedTakesNoOtherWithIt) {
  const test::TestFolder folder;
  const ScenePointer first = stone(201);
  const ScenePointer broken = in_folder(stone(151), folder / "broken");
  for (const char* level : {"level-0", "level-1"}) write_file(folder / "broken" / level / "mask.tif", "no picture");
  record_on(first, {broken, scanned_anew(151, 0.3)}, folder / "run.csv");
  const Table live(folder / "run.csv");
  std::set<std::string> touched;
  for (std::size_t row = 0; row < live.size(); ++row) touched.insert(live.at(row, "scene"));
  EXPECT_EQ(touched, (std::set<std::string>{"1", "3"}));
  EXPECT_FALSE(fs::exists(folder / "run.scenes" / "2"));
  EXPECT_EQ(differing_in_replay(first, folder / "run.csv", folder / "again.csv"), 0);
}

TEST(ScenesOfARecording, ThatCannotBeKeptAreToldWhileTheRunGoesOn) {
  const test::TestFolder folder;
  write_file(folder / "run.scenes", "in the way");
  const ScenePointer first = stone(101);
  Session session(first, make_simulated_device(4, 0.0), sparsha::test::options_of(first, folder / "run.csv"));
  session.start();
  session.set_scene(with_a_soft_part(first));
  const auto told = [&] {
    session.poll();
    const auto all = session.announcements().since(0);
    return std::any_of(all.begin(), all.end(), [](const Announcement& a) {
      return a.priority == Announcement::Priority::warning && a.text.starts_with("It cannot be kept: ");
    });
  };
  // Only a scene that was touched is missed at the end, and the warning may come before the first tick.
  const auto touched = [&] { return session.state().read().tick > 1; };
  for (int k = 0; k < 2000 && !(told() && touched()); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(told());
  EXPECT_TRUE(touched());
  EXPECT_THAT(error_of([&] { session.stop(); }, ErrorKind::failure), HasSubstr("run.scenes"));
}

TEST(ScenesOfARecording, AMissingOrChangedSceneIsAnErrorThatNamesIt) {
  const test::TestFolder folder;
  const ScenePointer first = stone(201);
  record_on(first, {scanned_anew(151, 0.3)}, folder / "run.csv");
  const fs::path second = folder / "run.scenes" / "2";
  ASSERT_EQ(opening(folder / "run.csv"), "no error");
  fs::rename(second, folder / "away");
  EXPECT_THAT(opening(folder / "run.csv"), AllOf(HasSubstr(second.string()), HasSubstr("is not there"),
                                                 HasSubstr("the folder run.scenes beside the recording")));
  fs::rename(folder / "run.scenes", folder / "gone");
  EXPECT_THAT(opening(folder / "run.csv"), HasSubstr("run.scenes/1"));
  // Not even the scene that the run began on stands in for them.
  EXPECT_THAT(error_of([&] { Session(first, std::make_shared<const Recording>(folder / "run.csv"), {}); }),
              HasSubstr("another scene"));
  fs::rename(folder / "gone", folder / "run.scenes");
  fs::rename(folder / "away", second);

  const std::string yaml = read_file(second / "scene.yaml", kMost);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = yaml;
    changed.replace(changed.find(from), from.size(), to);
    write_file(second / "scene.yaml", changed);
    return opening(folder / "run.csv");
  };
  EXPECT_THAT(with("The middle", "Its middle"),
              AllOf(HasSubstr((second / "scene.yaml").string()), HasSubstr("changed after the recording was made")));
  EXPECT_THAT(with("nx: 151", "nx: 149"), HasSubstr((second / "level-0").string()));
  EXPECT_THAT(with("scene:", "scen:"), HasSubstr((second / "scene.yaml").string()));
  write_file(second / "scene.yaml", yaml);
  // Without its list, as a run that was killed leaves it, the folder is believed as far as windows fit.
  fs::rename(folder / "run.scenes" / "recording.yaml", folder / "list");
  EXPECT_EQ(opening(folder / "run.csv"), "no error");
  write_file(folder / "run.scenes" / "recording.yaml", "scenes: 3");
  EXPECT_THAT(opening(folder / "run.csv"), HasSubstr("recording.yaml"));
}

TEST(ScenesOfARecording, DamagedLayersAreAnErrorAndNoCrash) {
  const test::TestFolder folder;
  const ScenePointer first = stone(201);
  record_on(first, {scanned_anew(151, 0.3)}, folder / "run.csv");
  const fs::path level = folder / "run.scenes" / "2" / "level-0";
  for (const char* layer : {"height.tif", "mask.tif"}) {
    const std::string good = read_file(level / layer, kMost);
    const std::string other = read_file(folder / "run.scenes" / "1" / "level-0" / layer, kMost);
    for (const std::string& bad : {good.substr(0, good.size() / 2), std::string("no picture"), other, std::string()}) {
      write_file(level / layer, bad);
      EXPECT_THAT(error_of([&] {
                    const auto session = session_of(first, folder / "run.csv", SessionOptions{});
                    run_to_the_end(*session);
                  }),
                  HasSubstr(layer));
    }
    write_file(level / layer, good);
  }
  EXPECT_EQ(differing_in_replay(first, folder / "run.csv", folder / "again.csv"), 0);
}

TEST(ScenesOfARecording, ARecordingFromElsewhereReadsNothingOutsideItsFolder) {
  const test::TestFolder folder;
  fs::create_directories(folder / "given");
  fs::create_directories(folder / "private");
  const ScenePointer first = stone(201);
  record_on(first, {scanned_anew(151, 0.3)}, folder / "given" / "run.csv");
  const fs::path kept = folder / "given" / "run.scenes";
  const auto refused = [&](const fs::path& link) {
    fs::rename(link, folder / "private" / "it");
    fs::create_symlink(folder / "private" / "it", link);
    EXPECT_THAT(opening(folder / "given" / "run.csv"), HasSubstr("outside")) << link;
    EXPECT_EQ(opening(folder / "given" / "run.csv", scene::Trust::any_file), "no error") << link;
    fs::remove(link);
    fs::rename(folder / "private" / "it", link);
  };
  for (const fs::path& link : {kept, kept / "2", kept / "recording.yaml", kept / "2" / "scene.yaml",
                               kept / "2" / "level-0", kept / "2" / "level-0" / "mask.tif"})
    refused(link);
  EXPECT_EQ(opening(folder / "given" / "run.csv"), "no error");
}

class KeptFolder : public ::testing::Test {
 protected:
  /// A recording's end, as the session sees it.
  void keep(const std::vector<ScenePointer>& scenes) const {
    SceneKeeper keeper(folder_ / "run.csv", scenes.front());
    for (std::size_t k = 1; k < scenes.size(); ++k) keeper.keep(k + 1, scenes[k]);
    write_file(folder_ / "run.csv", "rows");
    std::vector<std::uint64_t> touched;
    for (std::size_t k = 0; k < scenes.size(); ++k) touched.push_back(k + 1);
    keeper.finish(sha256_of_file(folder_ / "run.csv"), touched);
  }
  [[nodiscard]] fs::path kept() const { return folder_ / "run.scenes"; }
  [[nodiscard]] std::vector<std::string> entries() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  const test::TestFolder folder_;
  const ScenePointer small_ = stone(101);
  const ScenePointer coarse_ = stone(31);
};

TEST_F(KeptFolder, IsNamedAfterItsRecording) {
  EXPECT_EQ(kept_folder_of("a/run.csv"), fs::path("a/run.scenes"));
  EXPECT_EQ(kept_folder_of("run"), fs::path("run.scenes"));
  EXPECT_EQ(kept_folder_of("run.scenes"), fs::path("run.scenes.scenes"));
  EXPECT_EQ(kept_folder_of("a.b.csv"), fs::path("a.b.scenes"));
}

TEST_F(KeptFolder, OfAnEarlierRecordingIsReplacedOrRemovedWithIt) {
  keep({small_, coarse_, small_});
  EXPECT_TRUE(fs::exists(kept() / "3"));
  keep({coarse_, small_});
  EXPECT_FALSE(fs::exists(kept() / "3"));
  EXPECT_EQ(scene::open_scene(kept() / "1")->description().levels.front().nx, 31);
  keep({small_});
  EXPECT_EQ(entries(), std::vector<std::string>{"run.csv"});
}

TEST_F(KeptFolder, WithAnythingElseInItStaysAsItIsAndTheNewScenesAreAnError) {
  const std::vector<std::function<void()>> works = {
      [&] { write_file(kept() / "notes.txt", "mine"); },
      [&] { write_file(kept() / "1" / "notes.yaml", "pins: []"); },
      [&] { write_file(kept() / "2" / "level-0" / "mine.tif", "mine"); },
      [&] { fs::create_directory(kept() / "4"); },
      [&] { fs::create_symlink(folder_.path(), kept() / "2" / "audio"); },
      [&] { write_file(kept() / "2" / "scene.yaml", read_file(kept() / "2" / "scene.yaml", kMost) + "# mine\n"); },
      [&] { fs::remove(kept() / "recording.yaml"); },
      [&] {
        fs::remove_all(kept());
        write_file(kept(), "a file of mine");
      }};
  for (std::size_t k = 0; k < works.size(); ++k) {
    SCOPED_TRACE(k);
    keep({small_, coarse_});
    works[k]();
    keep({small_});
    EXPECT_TRUE(fs::exists(kept())) << "not removed after a run of one scene";
    EXPECT_THAT(error_of([&] { keep({coarse_, small_}); }, ErrorKind::failure), AllOf(HasSubstr(kept().string())));
    EXPECT_EQ(entries(), (std::vector<std::string>{"run.csv", "run.scenes"}));
    if (fs::is_directory(kept())) {
      EXPECT_EQ(scene::open_scene(kept() / "1")->description().levels.front().nx, 101) << "still the old one";
    }
    fs::remove_all(kept());
  }
}

TEST_F(KeptFolder, ThatCannotBeWrittenEndsTheRunInAnErrorAndLeavesTheRecording) {
  write_file(kept(), "in the way");
  const ScenePointer first = stone(201);
  EXPECT_THAT(error_of([&] { record_on(first, {scanned_anew(151, 0.3)}, folder_ / "run.csv"); }, ErrorKind::failure),
              HasSubstr(kept().string()));
  EXPECT_EQ(entries(), (std::vector<std::string>{"run.csv", "run.scenes"}));
  EXPECT_EQ(read_file(kept(), 100), "in the way");
  EXPECT_GT(Table(folder_ / "run.csv").size(), 1000U);
}

TEST_F(KeptFolder, IsNotLeftByARunThatWasNotFinished) {
  {
    SceneKeeper keeper(folder_ / "run.csv", small_);
    keeper.keep(2, coarse_);
  }
  EXPECT_EQ(entries(), std::vector<std::string>{});
}

TEST_F(KeptFolder, NeverTakesThePlaceOfASceneThatIsTouched) {
  keep({small_, coarse_});
  EXPECT_THAT(error_of([&] { SceneKeeper(folder_ / "run.csv", scene::open_scene(kept() / "1")); }, ErrorKind::usage),
              HasSubstr("run.scenes"));
  EXPECT_THAT(error_of(
                  [&] {
                    keep({small_, scene::open_scene(kept() / "2")});
                  },
                  ErrorKind::failure),
              HasSubstr("lies in this folder"));
}

TEST_F(KeptFolder, IsAnErrorWhenASceneWasBuiltAnewWhileItWasTouched) {
  const ScenePointer opened = in_folder(small_, folder_ / "statue");
  SceneKeeper keeper(folder_ / "run.csv", opened);
  fs::remove_all(folder_ / "statue");
  in_folder(coarse_, folder_ / "statue");
  keeper.keep(2, coarse_);
  write_file(folder_ / "run.csv", "rows");
  EXPECT_THAT(error_of([&] { keeper.finish("0", {1, 2}); }, ErrorKind::failure), HasSubstr("statue was built anew"));
  EXPECT_FALSE(fs::exists(kept()));
}

TEST_F(KeptFolder, OfADeviceThereIsNone) {
  SceneKeeper keeper("/dev/null", small_);
  keeper.keep(2, coarse_);
  keeper.finish("0", {1, 2});
  EXPECT_EQ(keeper.failure(), "");
}

}  // namespace
}  // namespace sparsha::haptics
