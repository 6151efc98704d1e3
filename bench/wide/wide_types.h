#ifndef SEL_SHARED_WIDE_TYPES_H
#define SEL_SHARED_WIDE_TYPES_H
// Layout of the wide tree: the wall's binary tree collapsed to nodes of eight children [Ylitie17, doi:10.1145/3105762.3105773].
// Boxes are bytes on a grid of the node, and eight are tested side by side. A triangle has 3.5 bytes of nodes instead of 26.
// Built from a WallTree by bench/wide/wide_tree.cpp.
#ifdef __cplusplus
    #include <cstdint>
namespace seldinger {
using uint = std::uint32_t;
using uchar = unsigned char;
#endif

#define SEL_WIDE_LEAF 8  // most triangles in a leaf
// Entries that a walk may have to remember. Every level of wide nodes is at least three levels of the binary tree high. That
// tree's depth is below 48, so no path has more than 16 wide nodes, and each leaves seven children behind. The last vector is
// stored whole.
#define SEL_WIDE_STACK 128

// child: SEL_WIDE_NONE; index of a node; or, with the top bit, a leaf: bits 28-30 its triangles less one, the others the first.
#define SEL_WIDE_NONE 0xffffffffu
#define SEL_WIDE_IS_LEAF(child) ((child) >> 31)
#define SEL_WIDE_FIRST(child) ((child)&0x0fffffffu)
#define SEL_WIDE_COUNT(child) ((((child) >> 28) & 7u) + 1u)

// Box of child k from origin[d] + step[d] * lo[d][k] to the same with hi: without rounding these hold its triangles; what a walk
// rounds, it adds a margin for.
// Vertices of a leaf lie as [9][count] floats from 9 * first on, so that one load gives the same coordinate of all its triangles;
// eight more floats follow the last leaf.
typedef struct WideNode {
    float origin[3], step[3];  // [m], relative to the tree's centre
    uchar lo[3][8], hi[3][8];
    uint child[8];
} WideNode;  // 104 bytes

#ifdef __cplusplus
static_assert(sizeof(WideNode) == 104, "layout shared with kernels");
}  // namespace seldinger
#endif
#endif
