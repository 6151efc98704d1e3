# Run by EmbedKernels.cmake at build time: FUNCTION (its name), INPUTS (list of files), ROOT (folder their names are relative to), OUTPUT.
set(text "#include \"device/kernel_sources.h\"\nnamespace seldinger::device {\nconst std::vector<KernelSource>& ${FUNCTION}()\n{\n    static const std::vector<KernelSource> sources = {\n")
foreach(input IN LISTS INPUTS)
  file(RELATIVE_PATH name ${ROOT} ${input})
  file(READ ${input} content)
  # a raw string literal holds at most 64 KiB portably; no kernel file comes near
  string(APPEND text "        {\"${name}\", R\"SELKERNEL(${content})SELKERNEL\"},\n")
endforeach()
string(APPEND text "    };\n    return sources;\n}\n}  // namespace seldinger::device\n")
file(WRITE ${OUTPUT} "${text}")
