// Tests of deploy/security/make-keys, and of what the programs report for bad credentials: exit code 2 and
// one line that names the file, before DDS starts.
//
// CTest: RESOURCE_LOCK lane_2

#include "dds/security.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "dds/security.h"
#include "tests/domains.h"
#include "tests/support.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

test::Outcome make_keys(const std::string& arguments) {
  return test::shell("'" COPPICE_SOURCE_DIR "/deploy/security/make-keys' " + arguments);
}

const std::string signs =
    "openssl smime -sign -text -signer ca/permissions_ca.cert.pem -inkey ca/permissions_ca.key.pem";

std::map<std::string, std::string> files_in(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) all[entry.path().lexically_relative(folder)] = test::contents(entry.path());
  }
  return all;
}

class SecurityFiles : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = std::make_unique<test::TemporaryFolder>();
    for (const char* keys : {"ours", "theirs"})
      ASSERT_EQ(make_keys("'" + (folder->path() / keys).string() + "' --with-replayer").exit_code, 0);
  }
  static void TearDownTestSuite() { folder.reset(); }

  static fs::path ours() { return folder->path() / "ours"; }
  static fs::path theirs() { return folder->path() / "theirs"; }
  /// A copy of all of our credentials that a test may change.
  static fs::path copy(const std::string& name) {
    fs::copy(ours(), folder->path() / name, fs::copy_options::recursive);
    return folder->path() / name;
  }

  static std::unique_ptr<test::TemporaryFolder> folder;
};
std::unique_ptr<test::TemporaryFolder> SecurityFiles::folder;

TEST_F(SecurityFiles, BadArgumentsOfMakeKeysAreReportedAndMakeNothing) {
  const fs::path out = folder->path() / "none";
  const std::string named = "'" + out.string() + "' ";
  for (const std::string& arguments :
       {std::string(), std::string("''"), named + "--days", named + "--days 0", named + "--days -3",
        named + "--days 1e3", named + "--days 9999", named + "--bogus", named + named, named + "--renew",
        named + "--renew ca", named + "--revoke all", named + "--renew agent",
        named + "--renew agent --revoke agent", std::string("/proc/none")}) {
    const test::Outcome outcome = make_keys(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_NE(outcome.output.find("usage: make-keys"), std::string::npos)
        << arguments << ": " << outcome.output;
  }
  EXPECT_FALSE(fs::exists(out));
}

// A replayer may write every topic.
TEST_F(SecurityFiles, AReplayerGetsCredentialsOnlyOnRequest) {
  const fs::path out = folder->path() / "fleet";
  const std::string named = "'" + out.string() + "'";
  ASSERT_EQ(make_keys(named).exit_code, 0);
  EXPECT_TRUE(fs::exists(out / "observer"));
  EXPECT_FALSE(fs::exists(out / "replayer"));
  EXPECT_EQ(make_keys(named + " --renew replayer").exit_code, 2);
  ASSERT_EQ(make_keys(named + " --renew all").exit_code, 0);
  EXPECT_FALSE(fs::exists(out / "replayer"));
  ASSERT_EQ(make_keys(named + " --with-replayer").exit_code, 0);
  EXPECT_TRUE(fs::exists(out / "replayer" / "permissions.p7s"));
}

TEST_F(SecurityFiles, PrivateKeysBelongToTheirOwnersAndAuthorities) {
  std::size_t keys = 0;
  for (const auto& [file, content] : files_in(ours())) {
    if (content.find("PRIVATE KEY") == std::string::npos) continue;
    ++keys;
    EXPECT_EQ(fs::status(ours() / file).permissions(), fs::perms::owner_read | fs::perms::owner_write)
        << file;
    EXPECT_TRUE(file.starts_with("ca/") || file.ends_with("/key.pem")) << file;
    for (const auto& [other, same] : files_in(ours()))
      EXPECT_TRUE(other == file || same != content) << other << " is " << file;
  }
  EXPECT_EQ(keys, 2u + 6u) << "two authorities, six roles";
}

TEST_F(SecurityFiles, MakeKeysLeavesExistingFilesUnchanged) {
  const fs::path keys = copy("again");
  const auto before = files_in(keys);
  const test::Outcome again = make_keys("'" + keys.string() + "' --days 9");
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_EQ(again.output.find("made"), std::string::npos) << again.output;
  EXPECT_EQ(files_in(keys), before);

  fs::remove_all(keys / "observer");
  EXPECT_EQ(make_keys("'" + keys.string() + "'").exit_code, 0);
  const auto completed = files_in(keys);
  EXPECT_TRUE(completed.contains("observer/key.pem"));
  EXPECT_EQ(completed.at("agent/key.pem"), before.at("agent/key.pem"));
}

TEST_F(SecurityFiles, OnlyTheNamedRolesAreRenewed) {
  const fs::path keys = copy("renewed");
  const auto before = files_in(keys);
  const test::Outcome renewed = make_keys("'" + keys.string() + "' --renew agent --days 9");
  EXPECT_EQ(renewed.exit_code, 0) << renewed.output;
  const auto after = files_in(keys);
  for (const char* file : {"agent/key.pem", "agent/cert.pem", "agent/permissions.p7s"})
    EXPECT_NE(after.at(file), before.at(file)) << file;
  for (const char* file :
       {"broker/key.pem", "broker/cert.pem", "ca/identity_ca.key.pem", "agent/identity_ca.cert.pem"})
    EXPECT_EQ(after.at(file), before.at(file)) << file;
}

TEST_F(SecurityFiles, AllCertificatesThatTheRoleEverHadAreRevoked) {
  const fs::path keys = copy("revoked");
  fs::copy(keys / "agent" / "cert.pem", keys / "first.pem");
  ASSERT_EQ(make_keys("'" + keys.string() + "' --renew agent").exit_code, 0);
  fs::copy(keys / "agent" / "cert.pem", keys / "second.pem");
  const test::Outcome revoked = make_keys("'" + keys.string() + "' --revoke agent");
  ASSERT_EQ(revoked.exit_code, 0) << revoked.output;
  const auto verdict = [&](const std::string& certificate) {
    return test::shell("cd '" + keys.string() +
                       "' && openssl verify -CAfile ca/identity_ca.cert.pem -crl_check -CRLfile "
                       "broker/identity_crl.pem " +
                       certificate);
  };
  for (const char* taken_back : {"first.pem", "second.pem"})
    EXPECT_NE(verdict(taken_back).output.find("certificate revoked"), std::string::npos)
        << taken_back << ": " << verdict(taken_back).output;
  for (const char* good : {"agent/cert.pem", "broker/cert.pem", "observer/cert.pem"})
    EXPECT_EQ(verdict(good).exit_code, 0) << verdict(good).output;

  // The script was interrupted before there was a revocation list, and runs again.
  fs::copy(keys / "agent" / "cert.pem", keys / "third.pem");
  const test::Outcome cut_off = test::shell(
      "cd '" + (keys / "ca").string() +
      "' && rm identity_crl.pem && for serial in $(awk -F '\t' '$1 == \"V\" && $6 == \"/CN=agent\" "
      "{ print $4 }' index.txt); do openssl ca -config openssl.cnf -revoke issued/$serial.pem; done");
  ASSERT_EQ(cut_off.exit_code, 0) << cut_off.output;
  EXPECT_EQ(make_keys("'" + keys.string() + "' --revoke agent").exit_code, 0);
  EXPECT_NE(verdict("third.pem").output.find("certificate revoked"), std::string::npos);
}

// 10,000 topics more than the role needs: 300 KB.
TEST_F(SecurityFiles, PermissionsMayBeLong) {
  const fs::path keys = copy("long");
  const test::Outcome changed = test::shell(
      "cd '" + keys.string() +
      "' && openssl smime -verify -text -noverify -in agent/permissions.p7s -out p.xml && "
      "awk '{ print } /<publish>/ { for (k = 0; k < 10000; ++k) print \"<topic> another_one </topic>\" }' "
      "p.xml >long.xml && " +
      signs + " -in long.xml -out agent/permissions.p7s");
  ASSERT_EQ(changed.exit_code, 0) << changed.output;
  EXPECT_NO_THROW(check_credentials((keys / "agent").string(), Role::agent));
  EXPECT_THROW(check_credentials((keys / "agent").string(), Role::broker), std::runtime_error);
}

/// An agent's credentials with one fault, and the error that must be reported.
struct Bad {
  std::string name;
  std::string change;  ///< a shell command in the folder that holds the credentials of all roles
  std::string file;
  std::string problem;
};

std::vector<Bad> bad_credentials(const fs::path& theirs) {
  std::vector<Bad> all = {
      {"no folder", "rm -r agent", "identity_ca.cert.pem", "No such file"},
      {"no certificate", "echo nonsense >agent/cert.pem", "cert.pem", "no certificate"},
      {"no key", "echo nonsense >agent/key.pem", "key.pem", "no private key"},
      {"a key with a password",
       "openssl ec -aes128 -passout pass:secret -in broker/key.pem -out agent/key.pem", "key.pem",
       "password"},
      {"another role's identity", "cp broker/cert.pem broker/key.pem agent", "cert.pem",
       "belongs to CN=broker"},
      {"another's key", "cp broker/key.pem agent/key.pem", "key.pem", "is not the private key of cert.pem"},
      {"another authority", "cp '" + theirs.string() + "/agent/identity_ca.cert.pem' agent/", "cert.pem",
       "issuer"},
      {"expired",
       "openssl req -new -key agent/key.pem -subj /CN=agent -out csr && cd ca && openssl ca -config "
       "openssl.cnf -batch "
       "-notext -startdate 20240101000000Z -enddate 20240201000000Z -in ../csr -out ../agent/cert.pem",
       "cert.pem", "expired on Feb  1 00:00:00 2024"},
      {"not yet",
       "openssl req -new -key agent/key.pem -subj /CN=agent -out csr && cd ca && openssl ca -config "
       "openssl.cnf -batch "
       "-notext -startdate 20990101000000Z -enddate 20990201000000Z -in ../csr -out ../agent/cert.pem",
       "cert.pem", "is not valid before Jan  1"},
      {"nothing signed", "echo nonsense >agent/governance.p7s", "governance.p7s", "not a signed document"},
      {"changed after it was signed", "sed -i s/ENCRYPT/NONE/ agent/governance.p7s", "governance.p7s",
       "is not signed by"},
      {"another authority's permissions", "cp '" + theirs.string() + "/agent/permissions.p7s' agent/",
       "permissions.p7s", "is not signed by"},
      {"expired permissions",
       "openssl smime -verify -text -noverify -in agent/permissions.p7s -out p.xml && "
       "sed -i 's/<not_after>[0-9]*/<not_after>2025/; s/<not_before>[0-9]*/<not_before>2024/' p.xml && " +
           signs + " -in p.xml -out agent/permissions.p7s",
       "permissions.p7s", "expired on"},
      {"another role's", "rm -r agent && cp -r broker agent", "permissions.p7s",
       "does not allow to write root_nodes"},
      {"an empty list of what was taken back", "echo >agent/identity_crl.pem", "identity_crl.pem", "no list"},
  };
  for (const char* file : {"identity_ca.cert.pem", "cert.pem", "key.pem", "permissions_ca.cert.pem",
                           "governance.p7s", "permissions.p7s"})
    all.push_back({std::string("without ") + file, std::string("rm agent/") + file, file, "No such file"});
  return all;
}

TEST_F(SecurityFiles, BadCredentialsAreReportedInOneLineThatNamesTheFile) {
  int number = 0;
  for (const Bad& bad : bad_credentials(theirs())) {
    SCOPED_TRACE(bad.name);
    const fs::path keys = copy("bad" + std::to_string(++number));
    const test::Outcome changed = test::shell("cd '" + keys.string() + "' && " + bad.change);
    ASSERT_EQ(changed.exit_code, 0) << changed.output;
    for (const std::string& command :
         {"'" + test::program("robot_agent") + "' --name r1 --domain " + test::domain_name() +
              " --security '" + (keys / "agent").string() + "'",
          "'" + test::program("coppice") + "' run '" + (test::scenarios() / "rooms-8.json").string() +
              "' --security '" + keys.string() + "'"}) {
      const test::Outcome outcome = test::shell("timeout 20 " + command);
      EXPECT_EQ(outcome.exit_code, 2) << command;
      EXPECT_NE(outcome.output.find("agent/" + bad.file + ": "), std::string::npos) << outcome.output;
      EXPECT_NE(outcome.output.find(bad.problem), std::string::npos) << outcome.output;
      EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    }
  }
}

TEST_F(SecurityFiles, EveryRoleReportsBadCredentials) {
  const std::string options =
      " --domain " + test::domain_name() + " --security '" + (folder->path() / "nowhere").string() + "'";
  for (const std::string& command :
       {"'" + test::program("tree_broker") + "'", "'" + test::program("robot_agent") + "' --name r1",
        "'" + test::program("planner_service") + "' '" + (test::scenarios() / "rooms-8.json").string() +
            "'"}) {
    const test::Outcome outcome = test::shell("timeout 20 " + command + options);
    EXPECT_EQ(outcome.exit_code, 2) << command;
    EXPECT_NE(outcome.output.find("nowhere/identity_ca.cert.pem"), std::string::npos) << outcome.output;
  }
}

TEST_F(SecurityFiles, DiscoveryServersAreRefused) {
  const test::Outcome outcome =
      test::shell("timeout 20 '" + test::program("tree_broker") + "' --domain " + test::domain_name() +
                  " --discovery 127.0.0.1:11811 --security '" + (ours() / "broker").string() + "'");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.output.find("not through servers"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace coppice
