// The benchmarks' page: whole, readable without sight, and true to its CSV files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/report/chapters.h"
#include "bench/report/csv_table.h"
#include "bench/report/exponent.h"
#include "bench/report/html.h"
#include "tests/support/test_folder.h"

namespace sparsha::bench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

void write(const std::filesystem::path& file, const std::string& text) { std::ofstream(file) << text; }

/// Every tag that is opened is closed, in order; names of those that are not.
std::vector<std::string> unbalanced(const std::string& html) {
  std::vector<std::string> open;
  const std::regex tag("<(/?)([a-z0-9]+)([^>]*)>");
  for (std::sregex_iterator at(html.begin(), html.end(), tag), end; at != end; ++at) {
    const std::string name = (*at)[2], rest = (*at)[3];
    if (name == "meta" || name == "br" || (!rest.empty() && rest.back() == '/')) continue;
    if ((*at)[1].length() == 0) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return {"/" + name};
    } else {
      open.pop_back();
    }
  }
  return open;
}

class Page : public testing::Test {
 protected:
  test::TestFolder folder_;
};

TEST_F(Page, FieldsInQuotesKeepTheirCommasAndQuotes) {
  write(folder_ / "a.csv", "method,text,value\nx,\"one, \"\"two\"\"\",3\r\nshort\n");
  const auto table = read_table(folder_ / "a.csv");
  ASSERT_TRUE(table);
  EXPECT_THAT(table->names, ElementsAre("method", "text", "value"));
  ASSERT_EQ(table->rows.size(), 2U);
  EXPECT_EQ(table->text(0, "text"), "one, \"two\"");
  EXPECT_EQ(table->number(0, "value"), 3.0);
  EXPECT_TRUE(std::isnan(table->number(1, "value")));
  EXPECT_TRUE(std::isnan(table->number(0, "no such column")));
  EXPECT_FALSE(read_table(folder_ / "missing.csv"));
}

TEST_F(Page, ARowWithMoreFieldsThanTheHeaderIsRefusedAndNotShownInTheWrongColumns) {
  write(folder_ / "a.csv", "method,rms_mm\nsparsha,0.1\nPCL MLS, mean,0.2\n");
  try {
    static_cast<void>(read_table(folder_ / "a.csv"));
    FAIL() << "the row was taken";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.csv:3: error: the row has 3 fields; 2"));
  }
}

TEST_F(Page, TextOfAFileCannotBecomeMarkup) {
  write(folder_ / "a.csv", "method,value\n<script>alert(1)</script>,2\n");
  const std::string html = html_of(folder_ / "a.csv", "A & B", {{"method", "method"}, {"value", "value"}});
  EXPECT_THAT(html, Not(HasSubstr("<script>")));
  EXPECT_THAT(html, HasSubstr("&lt;script&gt;"));
  EXPECT_THAT(html, HasSubstr("<caption>A &amp; B</caption>"));
}

TEST_F(Page, TextOfAFileCannotLeaveAnAttributeAndBytesThatAreNoTextAreShownAsSuch) {
  write(folder_ / "a.csv", "method,value\nit's\xFF,2\n");
  const std::string html = html_of(folder_ / "a.csv", "c", {{"method", "method"}, {"value", "value"}});
  EXPECT_THAT(html, HasSubstr("it&#39;s\uFFFD"));
  EXPECT_THAT(html, Not(HasSubstr("\xFF")));
}

TEST_F(Page, ValuesBeyondTheirLimitAreMarkedAndThoseBelowAreNot) {
  write(folder_ / "a.csv", "method,share\ngood,0.05\nbad,0.09\n");
  const std::string html = html_of(folder_ / "a.csv", "c", {{"method", "method"}, {"share", "%", 100.0, 7.0}});
  EXPECT_THAT(html, HasSubstr("<td>5</td>"));
  EXPECT_THAT(html, HasSubstr("<td class=\"fault\">9</td>"));
}

TEST_F(Page, AColumnThatAFileLacksIsLeftOutHeadAndAll) {
  write(folder_ / "a.csv", "method\nx\n");
  const std::string html = html_of(folder_ / "a.csv", "c", {{"method", "method"}, {"gone", "gone head"}});
  EXPECT_THAT(html, Not(HasSubstr("gone head")));
}

TEST_F(Page, IsOneFileWithALanguageHeadingsThatTheContentsReachAndNothingFromElsewhere) {
  write(folder_ / "friction.csv", "method,source,slide_error,tick_ns\nours,docs,0.01,12\n");
  write(folder_ / "sound.csv", "method,voices,modes,stroke,core_share\nmodal,32,32,1,0.02\n");
  write(folder_ / "pipeline_scaling.csv",
        "stage,against,points,nodes,seconds\nproject,points,10000,160000,0.01\nproject,points,100000,160000,0.1\n"
        "project,points,1000000,160000,1\n");
  write(folder_ / "pipeline_sites.csv",
        "program,points,seconds,cpu_seconds,peak_mb,read_mb,written_mb\nours,10000,0.2,0.2,60,2,1\n"
        "ours,100000,2,2,600,20,10\npeer,10000,9,9,70,3,1\n");
  const std::string body = effects_html(folder_.path()) + scaling_html(folder_.path()) +
                           real_time_html(folder_.path()) + files_html(folder_.path());
  const std::string page = html_page("Speed", "<p>Hello</p>", body);
  EXPECT_THAT(unbalanced(page.substr(page.find("<html"))), testing::IsEmpty());
  EXPECT_THAT(page, HasSubstr("<html lang=\"en\">"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"(https?:)?//")));
  const std::regex link("href=\"#([^\"]+)\"");
  int links = 0;
  for (std::sregex_iterator at(page.begin(), page.end(), link), end; at != end; ++at, ++links)
    EXPECT_THAT(page, HasSubstr("id=\"" + (*at)[1].str() + "\"")) << (*at)[1];
  EXPECT_GE(links, 4);
  EXPECT_THAT(page, HasSubstr(">1.00 ± 0.00 (3 sizes)<"));
  EXPECT_THAT(page, HasSubstr(">600 MB<"));
  EXPECT_THAT(page, HasSubstr(">1.00 (2 sizes)<")) << "of a whole program";
  EXPECT_THAT(page, HasSubstr(">too short to tell<")) << "of a peer at one size";
  // Every table has a caption, and every cell belongs to a head.
  const auto count = [&](const std::string& what) {
    int found = 0;
    for (std::size_t at = page.find(what); at != std::string::npos; at = page.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<table>"), count("<caption>"));
  EXPECT_EQ(count("<th "), count("<th scope="));
}

TEST_F(Page, AFolderWithoutFilesGivesChaptersWithoutTablesAndNoFindings) {
  EXPECT_EQ(effects_html(folder_.path()), "");
  EXPECT_EQ(pipeline_html(folder_.path()), "");
  EXPECT_EQ(real_time_html(folder_.path()), "");
  EXPECT_EQ(scaling_html(folder_.path()), "");
  EXPECT_EQ(paper_html(folder_.path()), "");
  EXPECT_EQ(findings_html(folder_.path()), "");
}

TEST_F(Page, FindingsNameThePeerThatIsBetterThanOurs) {
  write(folder_ / "pipeline_open_peers.csv",
        "method,back,varied,rms_away_mm\nsparsha,sparse,base,0.2\nmedian,sparse,base,0.1\nmean,sparse,base,3\n"
        "mean,dense,base,0.01\n");
  const std::string html = findings_html(folder_.path());
  EXPECT_THAT(html, HasSubstr("0.2 mm RMS, the best other way (median) 0.1 mm"));
}

TEST_F(Page, FindingsNameWhoMissesTheContactInMostTicks) {
  write(folder_ / "race.csv",
        "method,group,surface,points,lost\nmls,surfaces,scan: lion,1e5,0.72\nbox,surfaces,scan: lion,1e5,0.5\n"
        "sphere,depth,plane,1e5,0.9\n");
  const std::string html = findings_html(folder_.path());
  EXPECT_THAT(html, HasSubstr("<code>mls</code> on scan: lion of 100000 points (72 %)."));
  EXPECT_THAT(html, Not(HasSubstr("box")));
  EXPECT_THAT(html, Not(HasSubstr("sphere")));
}

TEST(Exponent, IsFoundFromAnExactPowerAndHasNoError) {
  std::vector<double> counts, seconds;
  for (double n = 1e3; n < 2e6; n *= 10.0) {
    counts.push_back(n);
    seconds.push_back(3e-7 * std::pow(n, 1.5));
  }
  const Exponent fit = fit_exponent(counts, seconds, 0.0);
  EXPECT_NEAR(fit.value, 1.5, 1e-12);
  EXPECT_NEAR(fit.error, 0.0, 1e-6);
  EXPECT_EQ(fit.counts, counts.size());
}

TEST(Exponent, LeavesOutTimesBelowTheFloorWhichWouldFlattenIt) {
  const std::vector<double> counts{1e3, 1e4, 1e5, 1e6}, seconds{1e-3, 1.1e-3, 1e-1, 1.0};
  EXPECT_NEAR(fit_exponent(counts, seconds, 0.01).value, 1.0, 1e-12);
  EXPECT_LT(fit_exponent(counts, seconds, 0.01).counts, 3U);
  EXPECT_LT(fit_exponent({5.0}, {1.0}, 0.0).counts, 2U);
}

TEST(Exponent, ItsIntervalHoldsTheTruthInNineteenOfTwentyNoisySeries) {
  std::uint64_t state = 12345;
  const auto uniform = [&state] {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  int held = 0;
  constexpr int kSeries = 1000;
  for (int series = 0; series < kSeries; ++series) {
    std::vector<double> counts, seconds;
    for (double n = 1e3; n < 2e8; n *= 10.0) {
      double noise = -6.0;
      for (int k = 0; k < 12; ++k) noise += uniform();
      counts.push_back(n);
      seconds.push_back(1e-6 * n * std::exp(0.2 * noise));
    }
    const Exponent fit = fit_exponent(counts, seconds, 0.0);
    held += std::abs(fit.value - 1.0) <= fit.error ? 1 : 0;
  }
  // Binomial: 950 expected, standard deviation 6.9.
  EXPECT_NEAR(held, 950, 28);
}

}  // namespace
}  // namespace sparsha::bench
