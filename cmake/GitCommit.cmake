# cmake -DROOT=... -DOUT=commit.cpp -DCOMMIT=... -P GitCommit.cmake: writes the commit of the sources as
#   std::string_view oraclegs::CommitText();   "abc1234", "abc1234-dirty", or "unknown" where git knows none
# Run by every build; the file changes only with the commit. A packager without git may give COMMIT.
cmake_minimum_required(VERSION 3.25)
if(NOT COMMIT)
  set(COMMIT "unknown")
  find_package(Git QUIET)
  if(Git_FOUND AND EXISTS "${ROOT}/.git")
    execute_process(COMMAND ${GIT_EXECUTABLE} -C ${ROOT} describe --always --abbrev=7 --dirty --exclude=*
                    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
    if(NOT failed AND described)
      set(COMMIT "${described}")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT
"// Made by cmake/GitCommit.cmake.
#include <string_view>

namespace oraclegs {
std::string_view CommitText();
std::string_view CommitText() { return \"@COMMIT@\"; }
}  // namespace oraclegs
")
