#pragma once
// One tree for all that ask about one wall: its centreline, the places where wires start, contact, and worlds made anew.

#include "vessel/tree.h"

#include <memory>

namespace seldinger {

/// The tree of this mesh, as build_wall_tree makes it. The latest one is kept: whoever asks for a mesh with the same content has
/// the same tree. Its users own it together, also when another takes its place here.
[[nodiscard]] std::shared_ptr<const WallTree> shared_wall_tree(const WallMesh& mesh);

/// Keeps a tree that build_wall_tree would make of this mesh (from a file).
void keep_wall_tree(const WallMesh& mesh, WallTree tree);
/// Call it when the tree is not needed for a while: it keeps 13 bytes per triangle instead of 80. The next user gets the tree in
/// 10 % of the time that it takes to build.
void shrink_kept_wall_tree();

}  // namespace seldinger
