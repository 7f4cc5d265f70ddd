#include "datasets/pictures/picture_times.hpp"
#include "datasets/pictures/name_time.hpp"
#include "datasets/sources/clock_seconds.hpp"

#include <gtest/gtest.h>

#include <map>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace picture_times_test {

using Names = std::vector<std::pair<std::string, double>>;

class PictureTimes : public testing::Test {
 protected:
  PictureTimes() { std::filesystem::create_directory(folder_ / "shots"); }
  void add(const std::string& name, const std::string& bytes = "picture") {
    folder_.write("shots/" + name, bytes);
    files_.push_back(folder_ / ("shots/" + name));
  }
  Names times(std::optional<double> rate = {}) {
    Names names;
    const TimedFiles timed = times_of_files(files_, rate);
    warnings_ = timed.warnings;
    caveat_ = timed.time_caveat;
    for (const TimedFile& file : timed.files) names.emplace_back(file.file.filename().string(), file.time);
    return names;
  }
  TemporaryFolder folder_;
  std::vector<std::filesystem::path> files_;
  std::vector<std::string> warnings_;
  std::string caveat_;
};

TEST_F(PictureTimes, WithoutAnyHintTheOrderOfTheNamesCountsWithNumbersByValue) {
  for (const char* name : {"a10.png", "a9.png", "a09b.png", "b1.png"}) add(name);
  EXPECT_EQ(times(), (Names{{"a9.png", 0}, {"a09b.png", 1}, {"a10.png", 2}, {"b1.png", 3}}));
  EXPECT_EQ(times(10.0), (Names{{"a9.png", 0}, {"a09b.png", 0.1}, {"a10.png", 0.2}, {"b1.png", 0.3}}));
}

TEST_F(PictureTimes, NamesThatAreNumbersAreTimesInSecondsOrFinerUnits) {
  for (const char* name : {"12.5.png", "3.png", "7.25.png"}) add(name);
  EXPECT_EQ(times(), (Names{{"3.png", 3}, {"7.25.png", 7.25}, {"12.5.png", 12.5}}));
  files_.clear();
  for (const char* name : {"1403636579763555584.png", "1403636579813555456.png"}) add(name);
  const Names fine = times();
  EXPECT_NEAR(fine[0].second, 1403636579.763555584, 1e-6);
  EXPECT_NEAR(fine[1].second - fine[0].second, 0.05, 1e-6);
}

TEST_F(PictureTimes, ClocksWithinNamesAreTimesAndOtherNumbersAreNot) {
  for (const auto& [stem, time] : {std::pair<const char*, double>{"depth_1305031102.160", 1305031102.16},
                                   {"1305031102.160-left", 1305031102.16},
                                   {"cam0_1403636579763555584", 1403636579763555584.0},
                                   {"0000012-000000400000", 0.4},
                                   {"-3.5", -3.5},
                                   {"frame_000012", -1},
                                   {"IMG_20261123071530", 1795418130.0},
                                   {"IMG_20261123_071530", 1795418130.0},
                                   {"20261123071530250", 1795418130.25},
                                   {"2026-11-23_07-15-30.250", 1795418130.25},
                                   {"cam_2026-11-23T07:15:30", 1795418130.0},
                                   {"IMG_20261323071530", -1},
                                   {"2024-01-02_1704186123.52", 1704186123.52},
                                   {"20240102_1704186123520", 1704186123520.0},
                                   {"cam20_1701121114150", 1701121114150.0},
                                   {"cam2_1701121114150", 1701121114150.0},
                                   {"IMG_20261123_071530_1", -1},
                                   {"20261123_071530_0001", -1},
                                   {"20261123_071530_250", 1795418130.25},
                                   {"scan_2021_10_04_000123", 1633305683.0},
                                   {"1970010203040506070", 1970010203040506070.0},
                                   {"1305031102_160000000", 1305031102.16},
                                   {"cloud_1583836591_182590976", 1583836591.182590976},
                                   {"scan-2-1583836591-182590976", 1583836591.182590976},
                                   {"1583836591_182590976_depth", 1583836591.182590976},
                                   {"cloud_11583836591_182590976", -1},
                                   {"cloud_1583836591_1825909760", -1},
                                   {"1305031102_16000000", -1},
                                   {"0000012-00000040000", -1},
                                   {"v1.2", -1},
                                   {"", -1}})
    EXPECT_DOUBLE_EQ(time_in_name(stem).value_or(-1), time) << stem;
  add("l_1305031102.50.png");
  add("l_1305031102.25.png");
  EXPECT_EQ(times(), (Names{{"l_1305031102.25.png", 1305031102.25}, {"l_1305031102.50.png", 1305031102.5}}));
  EXPECT_EQ(caveat_, "");
}

TEST_F(PictureTimes, NumbersThatWouldBeYearsApartAreNanosecondsFromAStart) {
  for (const char* name : {"0.png", "66666667.png", "133333333.png"}) add(name);
  Names found = times();
  EXPECT_NEAR(found[1].second, 0.066666667, 1e-12);
  EXPECT_NEAR(found[2].second, 0.133333333, 1e-12);
  EXPECT_NE(caveat_.find("years apart"), std::string::npos);
  files_.clear();
  for (const char* name : {"0.png", "60000000.png", "120500000.png", "200000000.png"}) add(name);
  EXPECT_NEAR(times()[2].second, 0.1205, 1e-12);
  files_.clear();
  for (int i = 0; i < 1200; ++i) add(std::to_string(100000L * i) + ".png");  // 10 a second, for two minutes
  EXPECT_NEAR(times()[1].second, 0.1, 1e-12);
}

TEST_F(PictureTimes, NanosecondsFromAStartMayHaveTenDigits) {
  for (const long start : {1500000000L, 5000000000L}) {
    files_.clear();
    for (int i = 0; i < 6; ++i) add(std::to_string(start + 100000000L * i) + ".png");
    const Names found = times();
    EXPECT_NEAR(found[5].second - found[0].second, 0.5, 1e-9) << start;
    EXPECT_NE(caveat_.find("years apart"), std::string::npos) << start;
  }
  files_.clear();
  for (long i = 0; i < 48; ++i) add(std::to_string(1600000000L + 2600000L * i) + ".png");  // one a month
  EXPECT_EQ(times()[1].second, 1602600000.0);
  EXPECT_EQ(caveat_, "");
}

TEST_F(PictureTimes, OfAClockInTwoUnitsAreRefused) {
  for (const char* name : {"1760000000123456789.png", "1760000000223456789.png", "1760000001.5.png"})
    add(name);
  const std::string sentence = complaint([&] { times(); });
  EXPECT_NE(sentence.find("'1760000001.5.png' and '1760000000223456789.png'"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("two units"), std::string::npos) << sentence;
  files_.clear();
  for (const char* name : {"0.png", "1760000000123456789.png", "1760000000223456789.png"}) add(name);
  EXPECT_NEAR(times()[1].second, 1760000000.123, 1e-3) << "a name without a time beside them";
}

TEST_F(PictureTimes, ATableAboutSomethingElseOrWrittenByTrackIsNone) {
  for (const char* name : {"1305031102.50.png", "1305031102.75.png"}) add(name);
  const Names expected{{"1305031102.50.png", 1305031102.5}, {"1305031102.75.png", 1305031102.75}};
  folder_.write("shots/imu.csv", "time,ax,ay\n1305031102.5,0.1,9.8\n");
  EXPECT_EQ(times(), expected);
  folder_.write("shots/t.csv", "time,file,kind,name\n0,1305031102.50.png,tag,3\n1,1305031102.75.png,tag,3\n");
  EXPECT_EQ(times(), expected);
  folder_.write("shots.csv", "time,file,kind,name\n0,1305031102.50.png,tag,3\n1,1305031102.75.png,tag,3\n");
  EXPECT_EQ(times(), expected);
  folder_.write("shots/real.csv", "5,1305031102.50.png\n6,1305031102.75.png\n");
  EXPECT_EQ(times(), (Names{{"1305031102.50.png", 5}, {"1305031102.75.png", 6}}));
  folder_.write("shots/again.csv", "7,1305031102.50.png\n8,1305031102.75.png\n");
  EXPECT_NE(complaint([&] { times(); }).find("several .csv files that name its pictures"), std::string::npos);
}

TEST_F(PictureTimes, ThatNothingSaysAreReported) {
  for (const char* name : {"7.png", "9.png"}) add(name);
  EXPECT_EQ(times(), (Names{{"7.png", 7}, {"9.png", 9}}));
  EXPECT_NE(caveat_.find("have no times"), std::string::npos);
  times(15.0);
  EXPECT_EQ(caveat_, "");
  folder_.write("associations.txt", "100 rgb/1.png 100.1 shots/7.png\n200 rgb/2.png 200.1 shots/9.png\n");
  EXPECT_EQ(times(), (Names{{"7.png", 100.1}, {"9.png", 200.1}}));
  EXPECT_TRUE(warnings_.empty());
  EXPECT_EQ(caveat_, "");
  EXPECT_NE(complaint([] { parse_associations("1 a.png 2\n", "times 'a'"); }).find("times 'a', line 1"),
            std::string::npos);
}

TEST_F(PictureTimes, OfTablesBelongToTheFileInTheFolderThatTheyName) {
  for (const char* name : {"7.png", "9.png"}) add(name);
  const Names expected{{"7.png", 100.1}, {"9.png", 200.1}};
  folder_.write("associations.txt", "100 rgb/7.png 100.1 ./shots/7.png\n200 rgb/9.png 200.1 ./shots/9.png\n");
  EXPECT_EQ(times(), expected);
  folder_.write("associations.txt", "100.1 /x/shots/7.png 100 rgb/7.png\n200.1 shots/9.png 200 rgb/9.png\n");
  EXPECT_EQ(times(), expected);
  folder_.write("associations.txt", "100 rgb/7.png 100.1 depth/7.png\n");  // of which of them is not said
  EXPECT_EQ(times(), (Names{{"7.png", 7}, {"9.png", 9}}));
  folder_.write("shots/t.csv", "100,rgb/7.png\n100.1,shots/7.png\n200.1,9.png\n");
  EXPECT_EQ(times(), expected);
}

TEST(MakeSeconds, TakesADateForNoClock) {
  for (const double last : {1e9, 202611230715.0, 20261123071531.0, 20261123071531000.0}) {
    std::vector<double> times{last - 8.0, last};
    make_seconds(times);
    EXPECT_EQ(times, (std::vector<double>{last - 8.0, last}));
  }
  std::vector<double> ends{9e11, 9.9e12};
  make_seconds(ends);
  EXPECT_NEAR(ends[1], 9.9e9, 1e-3);
}

TEST_F(PictureTimes, ExifCountsBeforeNamesWhenItDistinguishesAllPictures) {
  add("1.jpg", jpeg_taken("2001:09:09 01:46:42", "500"));
  add("2.jpg", jpeg_taken("2001:09:09 01:46:40", "250"));
  EXPECT_EQ(times(), (Names{{"2.jpg", 1e9 + 0.25}, {"1.jpg", 1e9 + 2.5}}));
  add("3.jpg", jpeg_taken("2001:09:09 01:46:40", "250"));  // a burst within the clock's step
  EXPECT_EQ(times(), (Names{{"1.jpg", 1}, {"2.jpg", 2}, {"3.jpg", 3}}));
  EXPECT_TRUE(caveat_.starts_with("EXIF states one time for several of the pictures")) << caveat_;
}

TEST_F(PictureTimes, ATableBesideThemCountsFirstAndWhatItDoesNotNameIsReportedAndLeftOut) {
  for (const char* name : {"1.png", "2.png", "3.png"}) add(name);
  folder_.write("shots/times.csv",
                "time,file\n# by hand\n20.5,1.png\n \"10.25\" , \"2.png\" \n30,gone.png\n");
  EXPECT_EQ(times(), (Names{{"2.png", 10.25}, {"1.png", 20.5}}));
  ASSERT_EQ(warnings_.size(), 2U);
  EXPECT_NE(warnings_[0].find("no time for 1 of 3 pictures"), std::string::npos);
  EXPECT_NE(warnings_[1].find("names 1 picture that is not there"), std::string::npos);
  folder_.write("shots/other.csv", "");
  EXPECT_EQ(times(), (Names{{"2.png", 10.25}, {"1.png", 20.5}}));
  ASSERT_EQ(warnings_.size(), 3U);
  EXPECT_NE(warnings_[2].find("other.csv' gives none of the pictures a time"), std::string::npos);
}

TEST_F(PictureTimes, WholeSecondsThatAreFarApartMayBeMilliseconds) {
  const auto told = [&](double step) {
    std::string table = "time,file\n";
    for (int i = 0; i < 6; ++i) table += std::to_string(step * i) + ",p" + std::to_string(i) + ".png\n";
    folder_.write("shots/times.csv", table);
    times();
    return !warnings_.empty() && warnings_.back().find("are their times milliseconds?") != std::string::npos;
  };
  for (int i = 0; i < 6; ++i) add("p" + std::to_string(i) + ".png");
  for (const double step : {33.0, 100.0}) EXPECT_TRUE(told(step)) << step;
  for (const double step : {0.1, 1.0, 9.0, 12.5}) EXPECT_FALSE(told(step)) << step;
}

TEST_F(PictureTimes, TheTableOfTheTumBenchmarkLiesBesideTheFolder) {
  for (const char* name : {"a.png", "b.png"}) add(name);
  folder_.write("shots.txt", "# color images\n# timestamp filename\n2.5 shots/a.png\n1.5 shots/b.png\n");
  EXPECT_EQ(times(), (Names{{"b.png", 1.5}, {"a.png", 2.5}}));
  folder_.write("shots.txt", "some notes on these\n");  // no table: nothing to complain of
  EXPECT_EQ(times(), (Names{{"a.png", 0}, {"b.png", 1}}));
}

TEST(FileTimes, AreReadInEitherOrderAndRefusedWithTheLine) {
  EXPECT_EQ(parse_file_times("1.5 x.png\n", "t"), (Names{{"x.png", 1.5}}));
  EXPECT_EQ(parse_file_times("x.png;1.5\r\n\r\n", "t"), (Names{{"x.png", 1.5}}));
  EXPECT_EQ(parse_file_times("#timestamp [ns],filename\n1403636579763555584,14.png\n", "t")[0].first,
            "14.png");
  EXPECT_EQ(complaint([] { parse_file_times("1,a.png\nsoon,b.png\n", "times 't'"); }),
            "times 't', line 2: expected a time and a file's name, got 'soon,b.png'");
  EXPECT_NE(complaint([] { parse_file_times("nan,b.png\n1,a.png\ninf,c.png\n", "t"); }), "");
  EXPECT_NE(complaint([] { parse_file_times("1\n", "t"); }), "");
}

TEST(NamesCaveat, TellsWhichTimesScansHaveUnlessTheirNamesAreAClocks) {
  const auto caveat = [](const std::vector<std::filesystem::path>& files) {
    return names_caveat(files, "clouds");
  };
  EXPECT_EQ(caveat({"1700000000.1.pcd", "1700000000.2.pcd"}), "");
  EXPECT_EQ(caveat({"scan_7.pcd"}), "");
  std::vector<std::filesystem::path> nanoseconds;
  for (int i = 0; i < 20; ++i) nanoseconds.emplace_back(std::to_string(100'000'000LL * i) + ".pcd");
  EXPECT_NE(caveat(nanoseconds).find("nanoseconds or microseconds from a start"), std::string::npos);
  EXPECT_NE(caveat({"1.pcd", "2.pcd"}).find("by the numbers in them, in seconds"), std::string::npos);
  EXPECT_NE(caveat({"f_10.5.pcd", "a_11.5.pcd"}).find("in the order of their names"), std::string::npos);
}

}  // namespace picture_times_test
}  // namespace clearway
