// Options of the address sanitizer in every program. Some programs start without the environment of the
// tests, as in containers.

/// Fast DDS as Debian builds it deletes some of its own objects with another size than it allocated them
/// with.
extern "C" const char* __asan_default_options() {
  return "new_delete_type_mismatch=0";
}

/// Fast DDS does not free what OpenSSL made of the credentials of a refused participant. Its frames are not
/// on the sanitizer's stack, because OpenSSL keeps no frame pointers.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libcrypto.so\n";
}
