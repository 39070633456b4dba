// A buffer of words.
#ifndef WORDS_GLSL
#define WORDS_GLSL

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint word; };

#endif
