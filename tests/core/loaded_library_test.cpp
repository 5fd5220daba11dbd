#include "oraclegs/core/loaded_library.h"

#include <gmock/gmock.h>

#include <cstdlib>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const LibraryKind kNumbers{
    "liboraclegs_numbers.so", "numbers", "ORACLEGS_NUMBERS_LIBRARY", "install it", "install libnumbers",
    "numbers_build",          "1"};

std::string Refused(const std::filesystem::path& file) {
  return MessageOf<UsageError>([&] { LoadedLibrary(kNumbers, file); });
}

TEST(LoadedLibrary, NamesTheFileAndTheFix) {
  const TempDir dir;
  WriteText(dir / "text.so", "no library");
  EXPECT_THAT(Refused("/nowhere/x.so"), testing::EndsWith("/nowhere/x.so: there is no such file; install it"));
  EXPECT_THAT(Refused(dir / "text.so"), HasSubstr("text.so: cannot be loaded; build it again, or install libnumbers"));
  EXPECT_THAT(Refused(*FindLibraryFile("liboraclegs_core.so")),
              AllOf(HasSubstr("is no library of numbers, it has no numbers_build"),
                    HasSubstr("name liboraclegs_numbers.so with $ORACLEGS_NUMBERS_LIBRARY")));
}

TEST(LoadedLibrary, GivesFunctions) {
  LibraryKind any = kNumbers;
  any.build_function = nullptr;
  const LoadedLibrary core(any, *FindLibraryFile("liboraclegs_core.so"));
  EXPECT_THROW(core.Find<void()>("no_such_function"), UsageError);
}

TEST(FindLibraryOf, TakesWhatTheVariableNames) {
  EXPECT_FALSE(HasLibraryOf(kNumbers));
  setenv(kNumbers.variable, "/nowhere/x.so", 1);
  EXPECT_EQ(FindLibraryOf(kNumbers), "/nowhere/x.so");
  EXPECT_FALSE(HasLibraryOf(kNumbers)) << "there is no such file";
  unsetenv(kNumbers.variable);
}

}  // namespace
}  // namespace oraclegs
