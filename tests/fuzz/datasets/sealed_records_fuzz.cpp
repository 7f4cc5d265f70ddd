// libFuzzer on the records of our own recordings.
#include "datasets/sources/sealed_records.hpp"

#include <fcntl.h>

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".rawlog");
  const int descriptor = ::open(file.write(fuzz::as_text(data, size)).c_str(), O_RDONLY);
  if (SealedRecords::are_in(descriptor, size)) {
    SealedRecords records(descriptor, size);
    for (std::uint64_t last = 0; const auto record = records.next(); last = records.offset()) {
      if (records.offset() < last || records.offset() > size) std::abort();
      if (!record->content && record->loss.empty()) std::abort();
    }
  }
  ::close(descriptor);
  return 0;
}
