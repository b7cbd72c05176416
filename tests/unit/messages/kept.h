// What a process stores for its successor.
#pragma once

#include <utility>

#include "messages/keep.h"

namespace coppice {

template <class Chooser>
struct Kept {
  explicit Kept(Chooser chooser = Chooser()) : keeper(std::move(chooser), &store) {}
  Kept(const Kept&) = delete;
  KeptInMemory store;
  Keeper<Chooser, KeptInMemory> keeper;
};

}  // namespace coppice
