#include "dds/security.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <regex>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fnmatch.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>

#include "messages/messages.h"
#include "messages/topics.h"

namespace coppice {

namespace {

// Frees an object of OpenSSL with OpenSSL's own function.
template <auto free>
struct Free {
  template <class T>
  void operator()(T* object) const {
    free(object);
  }
};
void free_list(STACK_OF(X509) * certificates) {
  sk_X509_free(certificates);
}
using Bio = std::unique_ptr<BIO, Free<BIO_free_all>>;
using Certificate = std::unique_ptr<X509, Free<X509_free>>;
using Certificates = std::unique_ptr<STACK_OF(X509), Free<free_list>>;
using Key = std::unique_ptr<EVP_PKEY, Free<EVP_PKEY_free>>;
using Store = std::unique_ptr<X509_STORE, Free<X509_STORE_free>>;
using StoreContext = std::unique_ptr<X509_STORE_CTX, Free<X509_STORE_CTX_free>>;
using Revocations = std::unique_ptr<X509_CRL, Free<X509_CRL_free>>;
using SignedDocument = std::unique_ptr<PKCS7, Free<PKCS7_free>>;
using Time = std::unique_ptr<ASN1_TIME, Free<ASN1_TIME_free>>;

[[noreturn]] void refuse(const std::string& file, const std::string& problem) {
  throw std::runtime_error(file + ": " + problem);
}

Bio open(const std::string& file) {
  errno = 0;
  Bio bio(BIO_new_file(file.c_str(), "r"));
  if (bio == nullptr) refuse(file, errno != 0 ? std::strerror(errno) : "cannot be read");
  return bio;
}

bool exists(const std::string& file) {
  return Bio(BIO_new_file(file.c_str(), "r")) != nullptr || errno != ENOENT;
}

/// Refuses to ask for a password, because nobody is there to type it.
int no_password(char*, int, int, void*) {
  return -1;
}

Certificate read_certificate(const std::string& file) {
  const Bio bio = open(file);
  Certificate certificate(PEM_read_bio_X509(bio.get(), nullptr, no_password, nullptr));
  if (certificate == nullptr) refuse(file, "holds no certificate in PEM");
  return certificate;
}

Key read_key(const std::string& file) {
  const Bio bio = open(file);
  Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_password, nullptr));
  if (key == nullptr) refuse(file, "holds no private key in PEM, or a private key with a password");
  return key;
}

std::string content_of(BIO* bio) {
  const char* text = nullptr;
  const auto length = static_cast<std::size_t>(BIO_get_mem_data(bio, &text));
  return {text, length};
}

std::string text_of(const ASN1_TIME* time) {
  const Bio bio(BIO_new(BIO_s_mem()));
  ASN1_TIME_print(bio.get(), time);
  return content_of(bio.get());
}

/// Describes what is wrong with these dates of validity now; empty if nothing is.
std::string problem_with_dates(const ASN1_TIME* first, const ASN1_TIME* last) {
  if (X509_cmp_current_time(last) < 0) return "expired on " + text_of(last);
  if (X509_cmp_current_time(first) > 0) return "is not valid before " + text_of(first);
  return {};
}

void check_dates(const std::string& file, const X509& certificate) {
  const std::string problem =
      problem_with_dates(X509_get0_notBefore(&certificate), X509_get0_notAfter(&certificate));
  if (!problem.empty()) refuse(file, problem);
}

/// `revocations`: name of a file, which may be missing.
void check_identity(const std::string& file, X509& identity, X509& authority,
                    const std::string& revocations) {
  check_dates(file, identity);
  const Store store(X509_STORE_new());
  X509_STORE_add_cert(store.get(), &authority);
  if (exists(revocations)) {
    const Bio bio = open(revocations);
    const Revocations list(PEM_read_bio_X509_CRL(bio.get(), nullptr, no_password, nullptr));
    if (list == nullptr) refuse(revocations, "holds no list of revocations in PEM");
    X509_STORE_add_crl(store.get(), list.get());
    X509_STORE_set_flags(store.get(), X509_V_FLAG_CRL_CHECK);
  }
  const StoreContext context(X509_STORE_CTX_new());
  X509_STORE_CTX_init(context.get(), store.get(), &identity, nullptr);
  if (X509_verify_cert(context.get()) != 1)
    refuse(file, X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get())));
}

/// Returns the content of a document that the authority has signed.
std::string read_signed(const std::string& file, X509& authority) {
  const Bio bio = open(file);
  BIO* detached = nullptr;
  const SignedDocument document(SMIME_read_PKCS7(bio.get(), &detached));
  const Bio body(detached);
  if (document == nullptr) refuse(file, "is not a signed document (S/MIME)");
  const Certificates signers(sk_X509_new_null());
  sk_X509_push(signers.get(), &authority);
  const Bio content(BIO_new(BIO_s_mem()));
  if (PKCS7_verify(document.get(), signers.get(), nullptr, body.get(), content.get(),
                   PKCS7_TEXT | PKCS7_NOVERIFY | PKCS7_NOINTERN) != 1)
    refuse(file, "is not signed by permissions_ca.cert.pem");
  return content_of(content.get());
}

/// Converts "2027-01-31T12:00:00", in UTC. Null if the text has another form.
Time time_of(std::string text) {
  std::erase_if(text, [](char c) { return c == '-' || c == ':' || c == 'T' || c == 'Z'; });
  Time time(ASN1_TIME_new());
  return ASN1_TIME_set_string_X509(time.get(), (text + "Z").c_str()) == 1 ? std::move(time) : nullptr;
}

/// At least one grant must be valid now. Fast DDS decides which grant belongs to this participant.
void check_validity(const std::string& file, const std::string& content) {
  static const std::regex validity(
      R"(<not_before>\s*([^<\s]*)\s*</not_before>\s*<not_after>\s*([^<\s]*)\s*</not_after>)");
  std::string problem = "grants nothing: no dates of validity";
  for (std::sregex_iterator grant(content.begin(), content.end(), validity), end; grant != end; ++grant) {
    const Time first = time_of((*grant)[1]);
    const Time last = time_of((*grant)[2]);
    problem = first && last ? problem_with_dates(first.get(), last.get())
                            : "dates of validity: expected YYYY-MM-DDThh:mm:ss";
    if (problem.empty()) return;
  }
  refuse(file, problem);
}

/// Returns the contents of all elements of that name. Does not use std::regex, whose recursion depth grows
/// with the length of the text.
std::vector<std::string_view> within(const std::string& element, std::string_view text) {
  const std::string opening = "<" + element + ">";
  const std::string closing = "</" + element + ">";
  std::vector<std::string_view> all;
  for (std::size_t at = text.find(opening); at != std::string_view::npos; at = text.find(opening, at)) {
    at += opening.size();
    const std::size_t end = text.find(closing, at);
    if (end == std::string_view::npos) break;
    all.push_back(text.substr(at, end - at));
  }
  return all;
}

std::string trimmed(std::string_view text) {
  constexpr const char* space = " \t\r\n";
  const std::size_t begin = std::min(text.find_first_not_of(space), text.size());
  return std::string(text.substr(begin, text.find_last_not_of(space) + 1 - begin));
}

/// The parts of a distinguished name ("CN=agent" and the like), independent of their order and separators.
std::set<std::string> parts_of_name(std::string_view name) {
  std::set<std::string> parts;
  while (!name.empty()) {
    const std::size_t end = std::min(name.find_first_of(",/+"), name.size());
    std::string part = trimmed(name.substr(0, end));
    std::erase(part, ' ');
    if (!part.empty()) parts.insert(std::move(part));
    name.remove_prefix(std::min(end + 1, name.size()));
  }
  return parts;
}

/// Refuses an identity of another subject than the permissions, even if both are signed correctly.
void check_subject(const std::string& file, X509& identity, const std::string& permissions) {
  const Bio text(BIO_new(BIO_s_mem()));
  X509_NAME_print_ex(text.get(), X509_get_subject_name(&identity), 0, XN_FLAG_RFC2253);
  const std::string subject = content_of(text.get());
  const bool granted = std::ranges::any_of(within("subject_name", permissions), [&](std::string_view name) {
    return parts_of_name(name) == parts_of_name(subject);
  });
  if (!granted)
    refuse(file,
           fmt::format("belongs to {}, to which permissions.p7s grants nothing: are these another role's "
                       "credentials?",
                       subject));
}

/// Returns the topics, or patterns of topics, within all elements of that name.
std::vector<std::string> topics_in(const std::string& element, const std::string& content) {
  std::vector<std::string> all;
  for (const std::string_view section : within(element, content)) {
    for (const std::string_view topic : within("topic", section)) all.push_back(trimmed(topic));
  }
  return all;
}

class Permissions {
 public:
  Permissions(std::string file, const std::string& content)
      : file_(std::move(file)),
        writes_(topics_in("publish", content)),
        reads_(topics_in("subscribe", content)) {}

  /// Checks all topics that the role reads or writes by the table of topics.
  template <class... Ms>
  void check(Role role, const std::variant<Ms...>*) const {
    (check(Topic<Ms>::info.name, Topic<Ms>::written_by(role), writes_, "write"), ...);
    (check(Topic<Ms>::info.name, Topic<Ms>::read_by(role), reads_, "read"), ...);
  }

 private:
  void check(std::string_view topic, bool needed, const std::vector<std::string>& allowed,
             const char* verb) const {
    const auto covers = [name = std::string(topic)](const std::string& pattern) {
      return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
    };
    if (needed && std::ranges::none_of(allowed, covers))
      refuse(file_,
             fmt::format("does not allow to {} {}: are these another role's credentials?", verb, topic));
  }

  std::string file_;
  std::vector<std::string> writes_;
  std::vector<std::string> reads_;
};

}  // namespace

void check_credentials(const std::string& folder, Role role) {
  const auto in_folder = [&](const char* name) { return folder + "/" + name; };
  for (const char* name : {"identity_ca.cert.pem", "cert.pem", "key.pem", "permissions_ca.cert.pem",
                           "governance.p7s", "permissions.p7s"})
    open(in_folder(name));
  const Certificate identity_authority = read_certificate(in_folder("identity_ca.cert.pem"));
  const Certificate identity = read_certificate(in_folder("cert.pem"));
  check_identity(in_folder("cert.pem"), *identity, *identity_authority, in_folder("identity_crl.pem"));
  if (X509_check_private_key(identity.get(), read_key(in_folder("key.pem")).get()) != 1)
    refuse(in_folder("key.pem"), "is not the private key of cert.pem");
  const Certificate permissions_authority = read_certificate(in_folder("permissions_ca.cert.pem"));
  check_dates(in_folder("permissions_ca.cert.pem"), *permissions_authority);
  read_signed(in_folder("governance.p7s"), *permissions_authority);
  const std::string permissions = in_folder("permissions.p7s");
  const std::string content = read_signed(permissions, *permissions_authority);
  check_validity(permissions, content);
  check_subject(in_folder("cert.pem"), *identity, content);
  Permissions(permissions, content).check(role, static_cast<const Message*>(nullptr));
}

void secure(const std::string& folder, eprosima::fastdds::dds::DomainParticipantQos& qos) {
  auto& properties = qos.properties().properties();
  const auto file = [&](const char* property, const char* name) {
    properties.emplace_back(property, "file://" + folder + "/" + name);
  };
  properties.emplace_back("dds.sec.auth.plugin", "builtin.PKI-DH");
  file("dds.sec.auth.builtin.PKI-DH.identity_ca", "identity_ca.cert.pem");
  file("dds.sec.auth.builtin.PKI-DH.identity_certificate", "cert.pem");
  file("dds.sec.auth.builtin.PKI-DH.private_key", "key.pem");
  if (exists(folder + "/identity_crl.pem"))
    file("dds.sec.auth.builtin.PKI-DH.identity_crl", "identity_crl.pem");
  properties.emplace_back("dds.sec.access.plugin", "builtin.Access-Permissions");
  file("dds.sec.access.builtin.Access-Permissions.permissions_ca", "permissions_ca.cert.pem");
  file("dds.sec.access.builtin.Access-Permissions.governance", "governance.p7s");
  file("dds.sec.access.builtin.Access-Permissions.permissions", "permissions.p7s");
  properties.emplace_back("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
}

}  // namespace coppice
