#include "mapping/system/input_file.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <stdexcept>

#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace input_file_test {

std::string refusal(const std::filesystem::path& file, std::size_t largest = 1000) {
  ::alarm(10);  // a reader that waits ends the test
  std::string sentence = "read";
  try {
    read_input(file, "map file", largest);
  } catch (const std::invalid_argument& error) {
    sentence = error.what();
  }
  ::alarm(0);
  return sentence;
}

TEST(InputFile, reads_every_byte_of_a_regular_file) {
  const TemporaryFolder folder;
  const std::string bytes("a\0\n\xff", 4);
  std::ofstream(folder / "f", std::ios::binary) << bytes;
  EXPECT_EQ(read_input(folder / "f", "file", 4), bytes);
  std::ofstream(folder / "empty").flush();
  EXPECT_EQ(read_input(folder / "empty", "file", 0), "");
  std::filesystem::create_symlink(folder / "f", folder / "link");
  EXPECT_EQ(read_input(folder / "link", "file", 4), bytes);
}

TEST(InputFile, pipes_devices_sockets_and_folders_are_refused_without_waiting) {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(refusal(pipe), "map file '" + pipe + "' cannot be read: it is a pipe, expected a regular file");
  std::filesystem::create_symlink(pipe, folder / "link");
  EXPECT_NE(refusal(folder / "link").find("it is a pipe"), std::string::npos);
  for (const char* device : {"/dev/zero", "/dev/null", "/dev/random"})
    EXPECT_NE(refusal(device).find("it is a device"), std::string::npos) << device;
  EXPECT_NE(refusal(folder / ".").find("it is a folder"), std::string::npos);

  const std::string name = folder / "socket";
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(name.size(), sizeof(address.sun_path));
  std::memcpy(address.sun_path, name.c_str(), name.size() + 1);
  ASSERT_EQ(::bind(socket, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  EXPECT_NE(refusal(name).find("it is not a regular file"), std::string::npos);
  ::close(socket);
}

TEST(InputFile, a_file_that_is_too_large_is_refused_before_it_is_read) {
  const TemporaryFolder folder;
  std::ofstream(folder / "huge").flush();
  std::filesystem::resize_file(folder / "huge", std::uintmax_t{1} << 40U);  // takes no disk
  EXPECT_NE(refusal(folder / "huge", 1U << 20U).find("more than 1 MB"), std::string::npos);
  EXPECT_NE(refusal(folder / "huge", 2U << 10U).find("more than 2 kB"), std::string::npos);
  EXPECT_NE(refusal("/nonexistent/x").find("No such file"), std::string::npos);
}

TEST(InputFile, the_case_of_an_extension_means_nothing) {
  EXPECT_EQ(extension_of("a/scan.PCD"), ".pcd");
  EXPECT_EQ(extension_of("A.b.Ply"), ".ply");
  EXPECT_EQ(extension_of("a.d/scan"), "");
}

TEST(InputFolder, StaysTheOneThatWasOpenedAndTellsWhatChanged) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"}) {
    std::filesystem::create_directory(folder / name);
    folder.write(std::string(name) + "/one", std::string(name) + "/one");
  }
  InputFolder opened(folder / "a");
  EXPECT_EQ(opened.read("one", "file", 10), "a/one");
  EXPECT_EQ(opened.read("two", "file", 10), std::nullopt);
  EXPECT_TRUE(opened.is_unchanged());
  std::filesystem::rename(folder / "a", folder / "c");
  std::filesystem::rename(folder / "b", folder / "a");
  EXPECT_FALSE(opened.is_unchanged());
  EXPECT_EQ(opened.read("one", "file", 10), "a/one");
  std::filesystem::remove_all(folder / "a");
  EXPECT_FALSE(opened.is_unchanged());

  const auto changed = [&](const std::function<void()>& change) {
    InputFolder again(folder / "c");
    EXPECT_EQ(again.read("one", "file", 10), "a/one");
    EXPECT_EQ(again.read("two", "file", 10), std::nullopt);
    EXPECT_TRUE(again.is_unchanged());
    change();
    return !again.is_unchanged();
  };
  EXPECT_FALSE(changed([&] { folder.write("c/three", "3"); }));  // nobody asked for it
  EXPECT_TRUE(changed([&] { folder.write("c/two", "2"); }));
  std::filesystem::remove(folder / "c/two");
  EXPECT_TRUE(changed([&] {  // of the same size
    folder.write("c/new", "a/one");
    std::filesystem::rename(folder / "c/new", folder / "c/one");
  }));
  EXPECT_TRUE(changed([&] { std::filesystem::remove(folder / "c/one"); }));
}

TEST(InputFolder, RefusesALinkThatLeadsNowhereAndFollowsOneThatLeadsSomewhere) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "a");
  folder.write("a/one", "1");
  std::filesystem::create_symlink("/nowhere", folder / "a/lost");
  std::filesystem::create_symlink("one", folder / "a/found");
  InputFolder opened(folder / "a");
  EXPECT_THROW(opened.read("lost", "file", 10), std::invalid_argument);
  EXPECT_EQ(opened.read("found", "file", 10), "1");
  EXPECT_THROW(opened.read("one", "file", 0), std::invalid_argument);
  EXPECT_THROW(InputFolder(folder / "none"), std::invalid_argument);
  EXPECT_THROW(InputFolder(folder / "a/one"), std::invalid_argument);
}

TEST(HeldInput, IsReadInPlaceOfAFileByThisThread) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("file", "disk");
  {
    const HeldInput held(file, "held");
    EXPECT_EQ(read_input(file, "file", 10), "held");
    {
      const HeldInput inner(file, "inner");
      EXPECT_EQ(read_input(file, "file", 10), "inner");
    }
    EXPECT_EQ(read_input(file, "file", 10), "held");
    EXPECT_EQ(HeldInput::of(folder / "other"), nullptr);
  }
  EXPECT_EQ(read_input(file, "file", 10), "disk");
}

}  // namespace input_file_test
}  // namespace clearway
