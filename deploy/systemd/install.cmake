# Installs the units of `folder`, with the folder `programs` (below the prefix) instead of /usr/local/bin. Writes the
# changed copies to `changed` first.
cmake_path(ABSOLUTE_PATH programs BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
file(GLOB units "${folder}/*.service")
foreach(unit IN LISTS units)
  file(READ "${unit}" text)
  string(REPLACE /usr/local/bin/ "${programs}/" text "${text}")
  cmake_path(GET unit FILENAME name)
  file(WRITE "${changed}/${name}" "${text}")
  file(INSTALL "${changed}/${name}" DESTINATION "${CMAKE_INSTALL_PREFIX}/lib/systemd/system")
endforeach()
