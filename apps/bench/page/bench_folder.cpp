#include "apps/bench/page/bench_folder.hpp"

#include <unistd.h>

namespace clearway::bench {

namespace fs = std::filesystem;

BenchFolder::BenchFolder(const std::string& benchmark)
    : path(fs::temp_directory_path() / ("clearway_bench_" + benchmark + "_" + std::to_string(::getpid()))) {
  fs::create_directories(path);
}

BenchFolder::~BenchFolder() {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

}  // namespace clearway::bench
