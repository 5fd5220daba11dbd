#include "oraclegs/networks/loader.h"

#include <cstdlib>

#include "support/errors.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string Refusal(const std::filesystem::path& library) {
  return MessageOf<UsageError>([&] { LoadNetworks(library); });
}

TEST(LoadNetworks, SaysThatThereIsNoFile) {
  EXPECT_THAT(Refusal("/nowhere/x.so"), AllOf(StartsWith("/nowhere/x.so: there is no such file; "),
                                              HasSubstr(HasNetworks() ? "oraclegs_networks_plugin" : "libtorch-dev")));
}

TEST(LoadNetworks, RefusesAFileThatIsNoLibrary) {
  const TempDir dir;
  WriteText(dir / "text.so", "no library");
  EXPECT_THAT(Refusal(dir / "text.so"), AllOf(HasSubstr("text.so: cannot be loaded; build it again")));
}

TEST(LoadNetworks, RefusesALibraryOfOtherThings) {
  EXPECT_THAT(Refusal(ORACLEGS_CORE_LIBRARY),
              AllOf(HasSubstr("is no library of networks"), HasSubstr("name liboraclegs_networks.so with "
                                                                      "$ORACLEGS_NETWORKS_LIBRARY")));
}

TEST(LoadNetworks, RefusesALibraryOfAnotherBuild) {
  EXPECT_THAT(Refusal(ORACLEGS_OTHER_BUILD),
              AllOf(HasSubstr("is of another build (0.0.0-of-another-build) than this program ("),
                    HasSubstr("build both together")));
}

TEST(GetNetworks, TakesWhatTheVariableNames) {
  setenv(kNetworksVariable, ORACLEGS_OTHER_BUILD, 1);
  EXPECT_THAT(WhyNoNetworks(), HasSubstr("is of another build"));
  EXPECT_TRUE(HasNetworksLibrary()) << "only the file is looked for";
  setenv(kNetworksVariable, "/nowhere/x.so", 1);
  EXPECT_THAT(WhyNoNetworks(), HasSubstr("/nowhere/x.so: there is no such file"));
  EXPECT_THROW(GetNetworks(), UsageError);
  EXPECT_FALSE(HasNetworksLibrary());
  EXPECT_THAT(MessageOf<UsageError>([] { RequireNetworksLibrary("--oracle vggt"); }),
              HasSubstr("--oracle vggt needs networks, and liboraclegs_networks.so is not here; "));
  unsetenv(kNetworksVariable);
}

TEST(GetNetworks, WithoutThemSaysWhichPackageBringsThem) {
  if (HasNetworks()) GTEST_SKIP() << "this build has networks";
  EXPECT_FALSE(HasNetworksLibrary());
  EXPECT_THAT(WhyNoNetworks(), AllOf(HasSubstr("libtorch-dev"), HasSubstr("-DORACLEGS_NETWORKS=ON")));
}

}  // namespace
}  // namespace oraclegs
