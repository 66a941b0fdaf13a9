// What is said to a visitor who cannot see: in which words, in which language, and what a second press adds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>

#include "base/phrases/phrases.h"
#include "haptics/session/announcer.h"
#include "tests/support/scenes.h"
#include "tests/support/whole_scenes.h"

namespace sparsha::haptics {
namespace {

class Words : public ::testing::Test {
 protected:
  /// A plate of 10 cm with a part in its upper left corner.
  static scene::ScenePointer plate() {
    return sparsha::test::scene_of([](double, double) { return 0.0; }, 101, 0.1, 200, Eigen::Vector3d::Zero(),
                                   [](scene::SceneDescription& d) {
                                     scene::PartConfig part{"lotus", "Lotus medallion", {0.0, 0.08, 0.02, 0.1}};
                                     part.more = "Eight petals, carved about the year 1000.";
                                     d.config.parts.push_back(part);
                                   });
  }
  static State at(double x_m, double y_m, bool touches = true) {
    State state;
    state.time_s = 100.0;
    state.contact = touches ? 1 : 0;
    state.proxy_m = {x_m, y_m, 0.0};
    state.place_m = state.proxy_m;
    return state;
  }
  std::string last() {
    const auto all = board_.since(0);
    return all.empty() ? std::string() : all.back().text;
  }
  AnnouncementBoard board_;
  Announcer english_{board_, plate()};
  Announcer hindi_{board_, plate(), Phrases::of("hi")};
};

TEST_F(Words, ASecondPressOnAPartTellsMoreAndAThirdBeginsAnew) {
  const View view{View::Kind::whole, 0.1, 1.0};
  english_.describe(at(0.01, 0.09), view);
  EXPECT_EQ(last(), "Lotus medallion. Upper left, touching. Whole stone, 10 centimetres across, at its own size.");
  english_.describe(at(0.01, 0.09), view);
  EXPECT_EQ(last(), "Eight petals, carved about the year 1000.");
  english_.describe(at(0.01, 0.09), view);
  EXPECT_EQ(last().rfind("Lotus medallion.", 0), 0U);
  // Another place in between: no more is told of a part that was left.
  english_.describe(at(0.05, 0.05), view);
  EXPECT_EQ(last(), "Middle of the stone, touching. Whole stone, 10 centimetres across, at its own size.");
  english_.describe(at(0.01, 0.09), view);
  EXPECT_EQ(last().rfind("Lotus medallion.", 0), 0U);
}

TEST_F(Words, PlacesOfAWholeObjectAreThoseThatSomebodySeesWhoHasTheSideBeforeHim) {
  using Eigen::Vector3d;
  const auto block = sparsha::test::whole_scene(sparsha::test::cube_charts(30, 0.001));
  Announcer announcer(board_, block);
  struct Turned {
    const char* side;
    Eigen::Quaterniond turn;  // brings the side before the visitor: about the upright, or tipped
  };
  const auto about = [](double degrees, const Vector3d& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180.0, axis));
  };
  for (const Turned& turned :
       {Turned{"Front", about(0.0, Vector3d::UnitY())}, Turned{"Back", about(180.0, Vector3d::UnitY())},
        Turned{"Right side", about(-90.0, Vector3d::UnitY())}, Turned{"Left side", about(90.0, Vector3d::UnitY())},
        Turned{"Top", about(90.0, Vector3d::UnitX())}, Turned{"Underside", about(-90.0, Vector3d::UnitX())}})
    for (const auto& [x, y, words] :
         {std::tuple(-0.02, 0.02, "upper left"), std::tuple(0.02, 0.0, "right, in the middle"),
          std::tuple(0.0, -0.02, "bottom, in the middle"), std::tuple(0.02, -0.02, "lower right")})
      for (const bool touches : {true, false}) {
        const Vector3d place_m = turned.turn.conjugate() * Vector3d(x, y, 0.03);
        State state = at(place_m.x(), place_m.y(), touches);
        state.proxy_m[2] = state.place_m[2] = place_m.z();
        const Vector3d normal = turned.turn.conjugate() * Vector3d::UnitZ();
        if (touches) state.normal = {normal.x(), normal.y(), normal.z()};
        state.turn = {turned.turn.x(), turned.turn.y(), turned.turn.z(), turned.turn.w()};
        state.flags |= kFlagAround;
        announcer.describe(state, {View::Kind::whole, 0.1, 1.0});
        std::string said = last().substr(0, last().find(touches ? ", touching" : ", in the air"));
        std::transform(said.begin(), said.end(), said.begin(), [](unsigned char c) { return std::tolower(c); });
        std::string wanted = touches ? std::string(turned.side) + ", " + words : words;
        std::transform(wanted.begin(), wanted.end(), wanted.begin(), [](unsigned char c) { return std::tolower(c); });
        EXPECT_EQ(said, wanted) << last();
      }
}

TEST_F(Words, APressAfterAPartWasSpokenByTouchTellsMoreAtOnce) {
  english_.watch(at(0.01, 0.09));
  EXPECT_EQ(last(), "Lotus medallion");
  english_.describe(at(0.01, 0.09), {});
  EXPECT_EQ(last(), "Eight petals, carved about the year 1000.");
}

TEST_F(Words, TwoPartsOfOneNameAreSpokenOfEach) {
  const auto twins = sparsha::test::scene_of([](double, double) { return 0.0; }, 101, 0.1, 200, Eigen::Vector3d::Zero(),
                                             [](scene::SceneDescription& d) {
                                               scene::PartConfig part{"leaf", "A leaf", {0.0, 0.0, 0.04, 0.1}};
                                               part.more = "It points to the left.";
                                               d.config.parts.push_back(part);
                                               part.box_m = {0.05, 0.0, 0.1, 0.1};
                                               part.more = "It points to the right.";
                                               d.config.parts.push_back(part);
                                             });
  Announcer announcer(board_, twins);
  State hand = at(0.02, 0.05);
  announcer.watch(hand);
  hand = at(0.07, 0.05);
  hand.time_s += 5.0;
  announcer.watch(hand);
  const auto all = board_.since(0);
  EXPECT_EQ(std::count_if(all.begin(), all.end(), [](const Announcement& a) { return a.text == "A leaf"; }), 2);
  announcer.describe(at(0.02, 0.05), {});
  EXPECT_EQ(last().rfind("A leaf. ", 0), 0U) << "the hand came back to the first: more is told on the next press";
  announcer.describe(at(0.07, 0.05), {});
  EXPECT_EQ(last().rfind("A leaf. ", 0), 0U) << last();
  announcer.describe(at(0.07, 0.05), {});
  EXPECT_EQ(last(), "It points to the right.");
}

TEST_F(Words, AnEdgeIsSaidWithTheWayBackToTheStone) {
  const std::vector<std::pair<std::array<double, 2>, std::string>> cases = {
      {{-0.01, 0.05}, "Edge of the stone, go right"},  {{0.11, 0.05}, "Edge of the stone, go left"},
      {{0.05, -0.01}, "Edge of the stone, go up"},     {{0.05, 0.11}, "Edge of the stone, go down"},
      {{-0.02, 0.101}, "Edge of the stone, go right"}, {{0.002, 0.05}, "Edge of the stone, go right"}};
  double time_s = 0.0;
  for (const auto& [place, expected] : cases) {
    State beside = at(place[0], place[1]);
    State inside = at(0.05, 0.05);
    inside.time_s = time_s += 10.0;
    english_.watch(inside);
    beside.flags = kFlagOutside;
    beside.time_s = time_s += 10.0;
    english_.watch(beside);
    EXPECT_EQ(last(), expected);
  }
}

TEST_F(Words, AnEdgeIsSaidOfATouchThatEndedBeforeAnybodyLookedAndNotOfAHandThatFliesAcross) {
  State beside = at(0.11, 0.05, false);
  beside.flags = kFlagOutside;
  english_.watch(beside);
  EXPECT_EQ(last(), "") << "never touched";
  beside.touched_s = beside.time_s - 1.5;
  english_.watch(beside);
  EXPECT_EQ(last(), "") << "flew across";
  beside.touched_s = beside.time_s - 0.3;
  english_.watch(beside);
  EXPECT_EQ(last(), "Edge of the stone, go left");
}

TEST_F(Words, TheNinePlacesOfTheStoneHaveTheNamesThatPeopleUse) {
  const std::vector<std::string> expected = {"Lower left",          "Bottom, in the middle", "Lower right",
                                             "Left, in the middle", "Middle of the stone",   "Right, in the middle",
                                             "Upper left",          "Top, in the middle",    "Upper right"};
  for (std::size_t k = 0; k < 9; ++k) {
    english_.describe(at(0.026 + 0.025 * static_cast<double>(k % 3), 0.026 + 0.025 * static_cast<double>(k / 3)), {});
    EXPECT_EQ(last().rfind(expected[k], 0), 0U) << last();
  }
}

TEST_F(Words, NoSentenceNamesALevelANegativeNumberOrAValueThatIsMissing) {
  for (Announcer* announcer : {&english_, &hindi_}) {
    for (int kind = 0; kind < 5; ++kind)
      for (const double scale : {0.01, 0.99, 1.0, 2.0, 3.7, 40.0}) {
        announcer->say_view({static_cast<View::Kind>(kind), 0.1 / scale, scale});
        announcer->say_first({static_cast<View::Kind>(kind), 0.1 / scale, scale});
      }
    for (const double x : {-0.2, -0.029, 0.0, 0.0001, 0.5})
      for (const double y : {-0.2, 0.0, 0.3}) {
        announcer->say_part(0, {x, y}, false);
        announcer->describe(at(x, y), {});
      }
  }
  const auto all = board_.since(0);
  EXPECT_EQ(all.size(), 64U);
  for (const Announcement& announcement : all)
    for (const char* forbidden : {"{", "}", "level", "Level", "-", "0 milli", "nan", "inf"})
      EXPECT_EQ(announcement.text.find(forbidden), std::string::npos) << announcement.text;
}

TEST_F(Words, TheWayToAPartIsADistanceAndAClockInEachLanguage) {
  english_.say_part(0, {0.104, 0.06}, false);  // 12 cm, 60 degrees clockwise from up
  EXPECT_EQ(last(), "Lotus medallion, 12 centimetres, two o'clock");
  hindi_.say_part(0, {0.104, 0.06}, false);
  EXPECT_EQ(last(), "Lotus medallion, 12 सेंटीमीटर, दो बजे की दिशा में");
  for (const bool under : {false, true}) {
    english_.say_part(0, {under ? 0.01 : 0.0, 0.0}, under);
    EXPECT_EQ(last(), "Lotus medallion is under your hand");
  }
}

TEST_F(Words, AreSaidAgainWhenAskedFor) {
  english_.repeat();
  EXPECT_EQ(last(), "") << "nothing has been said yet";
  english_.say("not_measured");
  english_.control(Announcement::Control::slower, "speech_slower");
  EXPECT_EQ(last(), "Slower");
  english_.repeat();
  EXPECT_EQ(last(), "Not measured here") << "not how it was to be said";
}

}  // namespace
}  // namespace sparsha::haptics
