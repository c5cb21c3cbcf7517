# At build time: puts the git commit into build_info.h, and leaves the file alone if nothing changed.
#   cmake -D SOURCE=folder -D TEMPLATE=file -D OUTPUT=file -P build_info.cmake
#
# It is the last commit that changed what the program is made from, not just any: a commit to the
# README leaves the program as it is, bit for bit, and the hash that runs are named by with it.

set(WISPLAB_COMMIT "")
set(WISPLAB_YEAR "")
set(changes "")
set(made_from CMakeLists.txt src integrators experiments)
if(EXISTS ${SOURCE}/.git)
  # safe.directory: in a container the folder often belongs to somebody else.
  set(git git --no-optional-locks -c safe.directory=${SOURCE} -C ${SOURCE})
  execute_process(COMMAND ${git} log -1 --format=%h --abbrev=12 -- ${made_from}
                  OUTPUT_VARIABLE WISPLAB_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${git} log -1 --format=%cd --date=format:%Y -- ${made_from}
                  OUTPUT_VARIABLE WISPLAB_YEAR OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${git} status --porcelain -- ${made_from}
                  OUTPUT_VARIABLE changes ERROR_QUIET)
endif()
if(NOT WISPLAB_COMMIT)
  set(WISPLAB_COMMIT unknown)
elseif(changes)
  string(APPEND WISPLAB_COMMIT -dirty)
endif()
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
