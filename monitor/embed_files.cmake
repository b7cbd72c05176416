# Writes OUT, the source that defines web_files() (monitor/server/web_files.h), from all files in FOLDER:
#   cmake -D FOLDER=... -D OUT=... -P embed_files.cmake
file(GLOB_RECURSE files RELATIVE ${FOLDER} ${FOLDER}/*)
list(SORT files)
set(entries "")
foreach(file ${files})
  file(READ ${FOLDER}/${file} bytes HEX)
  string(LENGTH "${bytes}" digits)
  math(EXPR size "${digits} / 2")
  string(REGEX REPLACE "(..)" "\\\\x\\1" literal "${bytes}")
  string(APPEND entries "    {\"/${file}\", {\"${literal}\", ${size}}},\n")
endforeach()
file(WRITE ${OUT} "#include \"monitor/server/web_files.h\"\n\nnamespace coppice {\n
std::span<const WebFile> web_files() {\n  static constexpr WebFile files[] = {\n${entries}  };\n  return files;\n}\n
}  // namespace coppice\n")
