# After the link of the tests: asks the program for its tests, and writes them down for ctest.
#   cmake -D PROGRAM=file -D OUTPUT=file -D TIMEOUT=seconds [-D PREFIX=text -D ONLY=a/b|c/d]
#         -P discover.cmake
#
# PREFIX is what the tests' names begin with. Of a suite that ONLY names a test of, there are only
# those.
#
# The list looks like this, a parameterised test being one line:
#   order: 2 tests
#   |-- first
#   `-- second (skipped)

file(REMOVE ${OUTPUT})
set(ENV{LC_ALL} C) # plain characters, and English
execute_process(COMMAND ${PROGRAM} --list --color=never
                OUTPUT_VARIABLE list RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --list failed: ${result}")
endif()

# A run whose filter matches nothing is a success to Criterion, and so is a test whose process finds
# a leak at its end: ctest looks for their words. A test that skips itself (a program is not
# installed here) is skipped to ctest too, and named as such.
set(failure "Tested: 0 |Sanitizer: |runtime error: ")
set(skip "not tried here: ")

set(script "")
set(expected 0)
set(found 0)
string(REGEX REPLACE "\n$" "" list "${list}")
string(REPLACE "\n" ";" list "${list}")
string(REPLACE "|" ";" only "${ONLY}")
foreach(line IN LISTS list)
  if(line MATCHES "^([A-Za-z0-9_]+): ([0-9]+) tests?$")
    set(suite ${CMAKE_MATCH_1})
    math(EXPR expected "${expected} + ${CMAKE_MATCH_2}")
  elseif(line MATCHES "^[|`]-- ([A-Za-z0-9_]+)( \\(skipped\\))?$")
    set(test ${suite}/${CMAKE_MATCH_1})
    set(skipped "${CMAKE_MATCH_2}")
    math(EXPR found "${found} + 1")
    if(";${ONLY}|" MATCHES "[;|]${suite}/")
      list(FIND only ${test} place)
      if(place EQUAL -1)
        continue()
      endif()
      list(REMOVE_ITEM only ${test})
    endif()
    set(properties "TIMEOUT ${TIMEOUT} ENVIRONMENT LC_ALL=C FAIL_REGULAR_EXPRESSION \"${failure}\"
                    SKIP_REGULAR_EXPRESSION \"${skip}\"")
    if(skipped)
      string(APPEND properties " DISABLED TRUE")
    endif()
    if(test MATCHES "(^|/)slow_") # left out where everything is slow: under sanitizers
      string(APPEND properties " LABELS slow")
    endif()
    string(APPEND script "add_test(${PREFIX}${test} \"${PROGRAM}\" --jobs 1 --filter ${test})\n"
                         "set_tests_properties(${PREFIX}${test} PROPERTIES ${properties})\n")
  else()
    message(FATAL_ERROR "${PROGRAM} --list: cannot read '${line}'")
  endif()
endforeach()
if(found EQUAL 0 OR NOT found EQUAL expected)
  message(FATAL_ERROR "${PROGRAM} --list: found ${found} tests where it says ${expected}")
endif()
if(only)
  message(FATAL_ERROR "${PROGRAM} --list: there is no ${only}, which CMakeLists.txt names")
endif()
file(WRITE ${OUTPUT} "${script}")
