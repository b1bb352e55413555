# cmake -D VENDOR=folder -P patch_laz.cmake: patches the crate laz 0.13.0 in a folder that cargo vendor has made.
#
# The times of points may come in several sequences. A point that switches to another sequence is decoded by a recursive call,
# and damaged data can switch without end, which overflows the stack: with an arithmetic decoder thousands of switches fit into
# a byte. Encoders switch once at most. The patched functions refuse the fifth switch in a row as invalid data.
# script/fuzz las has found this; no release of the crate corrects it.
file(GLOB crates ${VENDOR}/laz*)
list(LENGTH crates number)
if(NOT number EQUAL 1)
  message(FATAL_ERROR "${VENDOR} holds ${number} crates called laz")
endif()

# Replaces `call` after `before` everywhere in the file, and fails unless there are `times` such places.
function(limit_switches file before call next owner times)
  file(READ ${crates}/src/las/${file} text)
  string(REPLACE "${before}${call}?;" "" without "${text}")
  string(LENGTH "${text}" length)
  string(LENGTH "${without}" rest)
  string(LENGTH "${before}${call}?;" each)
  math(EXPR found "(${length} - ${rest}) / ${each}")
  if(NOT found EQUAL times)
    message(FATAL_ERROR "${crates}/src/las/${file} is not that of laz 0.13.0: '${call}' was found ${found} times")
  endif()
  string(REPLACE "${before}${call}?;" "${before}if ${next} >= 16 {
    return Err(std::io::ErrorKind::InvalidData.into());
}
${next} += 4; // what counts is next & 3
let switched = ${call};
${owner}.next &= 3;
switched?;" text "${text}")
  file(WRITE ${crates}/src/las/${file} "${text}")
endfunction()

file(READ ${crates}/.cargo-checksum.json sums)
string(REGEX REPLACE "\"files\":{[^}]*}" "\"files\":{}" sums "${sums}")
file(WRITE ${crates}/.cargo-checksum.json "${sums}")
limit_switches(gps.rs "& 3;\n                        " "self.decompress_with(&mut decoder, buf)" "self.common.next" "self.common" 2)
limit_switches(point6.rs "& 3;\n                    " "self.read_gps_time()" "the_context.gps_sequences.next"
  "self.contexts[self.current_context].gps_sequences" 2)
