// Takes the place of the C library's: no host has a name here, so that what is tried does not wait for the
// network.
#include <netdb.h>

extern "C" int getaddrinfo(const char*, const char*, const addrinfo*, addrinfo**) {
  return EAI_NONAME;
}
