// The page of figures, and what becomes of a benchmark that fails.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <sstream>
#include <stdexcept>

#include "apps/bench/page/own_process.hpp"
#include "apps/bench/page/page.hpp"

namespace clearway::bench {
namespace benchmark_page_test {

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

BenchResult twice_as_fast(const BenchOptions& options) {
  for (int run = 0; run < options.runs; ++run) options.say_run(run, options.runs);
  BenchResult result{1.0, 2.0, "a peer", "CPU ms", true, options.runs, {}};
  result.compared = "This against that.";
  result.tables = {{"Medians:", {"what", "ours"}, {{"all", "1.00"}}}};
  return result;
}

BenchResult failing(const BenchOptions&) { throw std::runtime_error("the peer differs"); }

std::vector<Outcome> outcomes_of(const std::vector<Entry>& entries, Progress progress) {
  return run_benchmarks(entries, {}, progress, [](const Outcome&) {});
}

std::vector<Outcome> one_good_one_bad() {
  std::ostringstream log;
  return outcomes_of({{"bad", "fails", 2, failing}, {"good", "works", 3, twice_as_fast}}, {log});
}

TEST(BenchmarkTable, a_pipe_or_a_line_end_does_not_end_a_cell) {
  EXPECT_EQ(escaped("a|b\nc"), "a\\|b c");
  const auto lines = lines_of(to_markdown({"", {"a|b"}, {{"c\nd"}}}));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0], "| a\\|b |");
}

TEST(BenchmarkTable, columns_are_aligned_and_numbers_stand_to_the_right) {
  const auto lines =
      lines_of(to_markdown({"", {"what", "us"}, {{"größer", "1,234"}, {"b", "5.6"}, {"c", "–"}}}));
  EXPECT_EQ(lines, (std::vector<std::string>{"| what   |    us |", "|--------|------:|", "| größer | 1,234 |",
                                             "| b      |   5.6 |", "| c      |     – |"}));
}

TEST(BenchmarkTable, a_row_of_another_length_is_refused) {
  EXPECT_THROW(to_markdown({"", {"one", "two"}, {{"alone"}}}), std::invalid_argument);
}

TEST(BenchmarkTable, figures_have_three_digits) {
  EXPECT_EQ(figure(3677.2), "3,677");
  EXPECT_EQ(figure(1234567.0), "1,234,567");
  EXPECT_EQ(figure(99.97), "100");
  EXPECT_EQ(figure(12.44), "12.4");
  EXPECT_EQ(figure(-1.5), "-1.50");
  EXPECT_EQ(figure(0.0312), "0.031");
  EXPECT_EQ(figure(2e-12), "2.0e-12");
  EXPECT_EQ(figure(0.0), "0");
  EXPECT_EQ(figure(1.0 / 0.0), "–");
  EXPECT_EQ(percent(0.087), "8.70 %");
  EXPECT_EQ(count_text(3), "3");
  EXPECT_EQ(length_text(0.0025), "2.5 mm");
  EXPECT_EQ(length_text(0.02), "2 cm");
}

TEST(BenchmarkTable, paragraphs_are_lines_that_an_editor_shows) {
  std::string text;
  for (int word = 0; word < 100; ++word) text += "wörter ";
  const auto lines = lines_of(wrapped(text));
  EXPECT_EQ(lines.size(), 6U);
  for (const std::string& line : lines) EXPECT_LE(line.size(), 118U + 17U) << line;
}

TEST(BenchmarkMachine, load_and_stolen_time_are_read_as_the_kernel_writes_them) {
  std::istringstream loads[2] = {std::istringstream("1.25 0.5 0.1 1/99 7"),
                                 std::istringstream("2 1 1 1/9 7")};
  std::istringstream ticks[2] = {std::istringstream("cpu 10 0 10 60 0 0 0 20 0 0\ncpu0 1 1"),
                                 std::istringstream("cpu 60 0 10 80 0 0 0 50 0 0\n")};
  const MachineLoad before = read_load(loads[0], ticks[0]), after = read_load(loads[1], ticks[1]);
  EXPECT_EQ(before.average, 1.25);
  EXPECT_EQ(stolen_share(before, after), 0.3);
  EXPECT_EQ(stolen_share(before, before), std::nullopt);
  std::istringstream cpuinfo("processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\n");
  EXPECT_EQ(cpu_model(cpuinfo), "Some CPU @ 2 GHz");
}

TEST(BenchmarkRun, a_benchmark_that_fails_is_named_and_stops_no_other) {
  const auto outcomes = one_good_one_bad();
  ASSERT_EQ(outcomes.size(), 2U);
  EXPECT_EQ(outcomes[0].failure, "the peer differs");
  EXPECT_TRUE(outcomes[1].failure.empty());
  EXPECT_EQ(exit_status(outcomes), 1);
  EXPECT_EQ(exit_status({outcomes[1]}), 0);
}

TEST(BenchmarkRun, a_process_of_its_own_hands_back_the_same_result) {
  BenchOptions options;
  options.runs = 2;
  const Benchmark infinite = [](const BenchOptions& asked) {
    BenchResult result = twice_as_fast(asked);
    result.peer = 1.0 / 0.0;
    result.detail["worst"] = 1e-12;
    return result;
  };
  const BenchResult here = infinite(options), there = isolated(infinite)(options);
  EXPECT_EQ(there.peer, here.peer);
  EXPECT_EQ(there.runs, 2);
  EXPECT_EQ(there.detail, here.detail);
  EXPECT_EQ(there.compared, here.compared);
  ASSERT_EQ(there.tables.size(), 1U);
  EXPECT_EQ(to_markdown(there.tables[0]), to_markdown(here.tables[0]));
}

TEST(BenchmarkRun, one_that_crashes_is_named_as_well) {
  const auto silent = [](const BenchOptions&) -> BenchResult { _exit(9); };
  const auto killed = [](const BenchOptions&) -> BenchResult {
    raise(SIGKILL);
    return {};
  };
  std::ostringstream log;
  const auto outcomes = outcomes_of({{"silent", "ends", 1, isolated(silent)},
                                     {"killed", "ends", 1, isolated(killed)},
                                     {"bad", "fails", 1, isolated(failing)},
                                     {"good", "works", 1, isolated(twice_as_fast)}},
                                    {log});
  EXPECT_EQ(outcomes[0].failure, "its process sent no result");
  EXPECT_EQ(outcomes[1].failure, "its process was ended by signal 9");
  EXPECT_EQ(outcomes[2].failure, "the peer differs");
  EXPECT_TRUE(outcomes[3].failure.empty());
}

TEST(BenchmarkRun, each_runs_as_often_as_it_says_unless_asked_otherwise) {
  std::ostringstream log;
  const std::vector<Entry> entries{{"good", "works", 3, twice_as_fast}};
  EXPECT_EQ(outcomes_of(entries, {log}).front().result.runs, 3);
  BenchOptions options;
  options.runs = 7;
  const auto asked = run_benchmarks(entries, options, {log}, [](const Outcome&) {});
  EXPECT_EQ(asked.front().result.runs, 7);
}

TEST(BenchmarkRun, progress_is_a_line_for_each_benchmark_and_where_asked_for_each_run) {
  const std::vector<Entry> entries{{"good", "works", 2, twice_as_fast}, {"bad", "fails", 1, failing}};
  std::ostringstream log, each;
  outcomes_of(entries, {log});
  const auto lines = lines_of(log.str());
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_TRUE(lines[0].starts_with("good (1 of 2): ")) << lines[0];
  EXPECT_NE(lines[1].find("the peer differs"), std::string::npos);
  outcomes_of(entries, {each, false, true});
  EXPECT_EQ(lines_of(each.str()).front(), "good (1 of 2): run 1 of 2");
}

TEST(BenchmarkPage, the_page_has_commit_date_machine_load_and_every_benchmark) {
  const std::string page =
      whole_page({"abc123", "2026-11-23", {"Some CPU", "AVX2", 2, 24.0}}, one_good_one_bad());
  for (const char* part :
       {"`abc123`", "2026-11-23", "Some CPU, AVX2, 2 cores, 24 GB", "load average", "stolen", "## good",
        "This against that.", "| all  | 1.00 |", "## bad", "Failed: the peer differs", "| 2.00 ",
        "clearway compare datasets/suites/guided.yaml"})
    EXPECT_NE(page.find(part), std::string::npos) << part << " is not in\n" << page;
}

TEST(BenchmarkPage, a_summary_has_the_figures_beside_ours_also_of_a_process_of_its_own) {
  const Benchmark run = isolated([](const BenchOptions& options) {
    BenchResult result = twice_as_fast(options);
    result.also = "p99 1.50";
    return result;
  });
  Outcome outcome = one_good_one_bad().back();
  outcome.result = run({});
  EXPECT_NE(whole_page({}, {outcome}).find("| CPU ms (p99 1.50) |"), std::string::npos);
}

TEST(BenchmarkPage, no_ratio_is_given_where_both_sides_answer_different_questions) {
  Outcome outcome = one_good_one_bad().back();
  outcome.result.no_ratio = "the peer sleeps.";
  EXPECT_NE(section(outcome).find("No ratio: the peer sleeps."), std::string::npos);
  EXPECT_EQ(whole_page({}, {outcome}).find("| 2.00 |"), whole_page({}, {outcome}).rfind("| 2.00 |"));
}

}  // namespace benchmark_page_test
}  // namespace clearway::bench
