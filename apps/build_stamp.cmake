# Writes OUTPUT, a source file that knows the commit of SOURCE. Run by the build whenever HEAD moves.
execute_process(COMMAND git -C ${SOURCE} rev-parse --short=12 HEAD
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed ERROR_QUIET)
if(failed)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "apps/console/build_stamp.hpp"

namespace clearway {

std::string_view build_commit() { return "@commit@"; }

}  // namespace clearway
]])
