#pragma once

// Entry points of OpenGL 4.5 core, loaded at run time. Debian 12 has no glad, and its glbinding cannot load
// through OSMesaGetProcAddress, so the list of what we call lives here.

#include <GL/glcorearb.h>

// clang-format off
#define SIGHTLINE_GL_FUNCTIONS(X) \
  X(ACTIVETEXTURE, glActiveTexture) \
  X(ATTACHSHADER, glAttachShader) \
  X(BEGINQUERY, glBeginQuery) \
  X(BINDBUFFER, glBindBuffer) \
  X(BINDBUFFERBASE, glBindBufferBase) \
  X(BINDBUFFERRANGE, glBindBufferRange) \
  X(BINDFRAMEBUFFER, glBindFramebuffer) \
  X(BINDIMAGETEXTURE, glBindImageTexture) \
  X(BINDTEXTUREUNIT, glBindTextureUnit) \
  X(BINDVERTEXARRAY, glBindVertexArray) \
  X(BLENDFUNC, glBlendFunc) \
  X(BLENDFUNCSEPARATE, glBlendFuncSeparate) \
  X(BLENDEQUATION, glBlendEquation) \
  X(BLITNAMEDFRAMEBUFFER, glBlitNamedFramebuffer) \
  X(CHECKNAMEDFRAMEBUFFERSTATUS, glCheckNamedFramebufferStatus) \
  X(CLEAR, glClear) \
  X(CLEARCOLOR, glClearColor) \
  X(CLEARDEPTH, glClearDepth) \
  X(CLEARSTENCIL, glClearStencil) \
  X(CLEARNAMEDBUFFERDATA, glClearNamedBufferData) \
  X(CLEARNAMEDFRAMEBUFFERFV, glClearNamedFramebufferfv) \
  X(CLEARNAMEDFRAMEBUFFERFI, glClearNamedFramebufferfi) \
  X(CLEARNAMEDFRAMEBUFFERUIV, glClearNamedFramebufferuiv) \
  X(CLEARNAMEDFRAMEBUFFERIV, glClearNamedFramebufferiv) \
  X(CLIPCONTROL, glClipControl) \
  X(COLORMASK, glColorMask) \
  X(COMPILESHADER, glCompileShader) \
  X(CREATEBUFFERS, glCreateBuffers) \
  X(CREATEFRAMEBUFFERS, glCreateFramebuffers) \
  X(CREATEPROGRAM, glCreateProgram) \
  X(CREATEQUERIES, glCreateQueries) \
  X(CREATESHADER, glCreateShader) \
  X(CREATETEXTURES, glCreateTextures) \
  X(CREATEVERTEXARRAYS, glCreateVertexArrays) \
  X(CULLFACE, glCullFace) \
  X(DELETEBUFFERS, glDeleteBuffers) \
  X(DELETEFRAMEBUFFERS, glDeleteFramebuffers) \
  X(DELETEPROGRAM, glDeleteProgram) \
  X(DELETEQUERIES, glDeleteQueries) \
  X(DELETESHADER, glDeleteShader) \
  X(DELETESYNC, glDeleteSync) \
  X(DELETETEXTURES, glDeleteTextures) \
  X(DELETEVERTEXARRAYS, glDeleteVertexArrays) \
  X(DEPTHFUNC, glDepthFunc) \
  X(DEPTHMASK, glDepthMask) \
  X(DISABLE, glDisable) \
  X(DISPATCHCOMPUTE, glDispatchCompute) \
  X(DRAWARRAYS, glDrawArrays) \
  X(DRAWELEMENTSINSTANCEDBASEINSTANCE, glDrawElementsInstancedBaseInstance) \
  X(ENABLE, glEnable) \
  X(ENABLEVERTEXARRAYATTRIB, glEnableVertexArrayAttrib) \
  X(ENDQUERY, glEndQuery) \
  X(FENCESYNC, glFenceSync) \
  X(FINISH, glFinish) \
  X(FLUSH, glFlush) \
  X(FRONTFACE, glFrontFace) \
  X(GENERATETEXTUREMIPMAP, glGenerateTextureMipmap) \
  X(GETERROR, glGetError) \
  X(GETINTEGERV, glGetIntegerv) \
  X(GETNAMEDBUFFERSUBDATA, glGetNamedBufferSubData) \
  X(GETPROGRAMINFOLOG, glGetProgramInfoLog) \
  X(GETPROGRAMIV, glGetProgramiv) \
  X(GETQUERYBUFFEROBJECTUI64V, glGetQueryBufferObjectui64v) \
  X(GETQUERYOBJECTUI64V, glGetQueryObjectui64v) \
  X(GETQUERYOBJECTUIV, glGetQueryObjectuiv) \
  X(GETSHADERINFOLOG, glGetShaderInfoLog) \
  X(GETSHADERIV, glGetShaderiv) \
  X(GETSTRING, glGetString) \
  X(GETTEXTUREIMAGE, glGetTextureImage) \
  X(GETUNIFORMLOCATION, glGetUniformLocation) \
  X(LINKPROGRAM, glLinkProgram) \
  X(MAPNAMEDBUFFERRANGE, glMapNamedBufferRange) \
  X(MEMORYBARRIER, glMemoryBarrier) \
  X(MULTIDRAWELEMENTSINDIRECT, glMultiDrawElementsIndirect) \
  X(NAMEDBUFFERDATA, glNamedBufferData) \
  X(NAMEDBUFFERSTORAGE, glNamedBufferStorage) \
  X(NAMEDBUFFERSUBDATA, glNamedBufferSubData) \
  X(NAMEDFRAMEBUFFERDRAWBUFFER, glNamedFramebufferDrawBuffer) \
  X(NAMEDFRAMEBUFFERDRAWBUFFERS, glNamedFramebufferDrawBuffers) \
  X(NAMEDFRAMEBUFFERREADBUFFER, glNamedFramebufferReadBuffer) \
  X(NAMEDFRAMEBUFFERTEXTURE, glNamedFramebufferTexture) \
  X(PIXELSTOREI, glPixelStorei) \
  X(POLYGONOFFSET, glPolygonOffset) \
  X(READBUFFER, glReadBuffer) \
  X(READPIXELS, glReadPixels) \
  X(SCISSOR, glScissor) \
  X(SHADERSOURCE, glShaderSource) \
  X(STENCILFUNC, glStencilFunc) \
  X(STENCILMASK, glStencilMask) \
  X(STENCILOP, glStencilOp) \
  X(TEXTUREPARAMETERF, glTextureParameterf) \
  X(TEXTUREPARAMETERI, glTextureParameteri) \
  X(TEXTURESTORAGE2D, glTextureStorage2D) \
  X(TEXTURESUBIMAGE2D, glTextureSubImage2D) \
  X(UNIFORM1F, glUniform1f) \
  X(UNIFORM1I, glUniform1i) \
  X(UNIFORM1UI, glUniform1ui) \
  X(UNIFORM2F, glUniform2f) \
  X(UNIFORM3F, glUniform3f) \
  X(UNIFORM3FV, glUniform3fv) \
  X(UNIFORM4F, glUniform4f) \
  X(UNIFORM4FV, glUniform4fv) \
  X(UNIFORMMATRIX3FV, glUniformMatrix3fv) \
  X(UNIFORMMATRIX4FV, glUniformMatrix4fv) \
  X(UNMAPNAMEDBUFFER, glUnmapNamedBuffer) \
  X(USEPROGRAM, glUseProgram) \
  X(VERTEXARRAYATTRIBBINDING, glVertexArrayAttribBinding) \
  X(VERTEXARRAYATTRIBFORMAT, glVertexArrayAttribFormat) \
  X(VERTEXARRAYATTRIBIFORMAT, glVertexArrayAttribIFormat) \
  X(VERTEXARRAYBINDINGDIVISOR, glVertexArrayBindingDivisor) \
  X(VERTEXARRAYELEMENTBUFFER, glVertexArrayElementBuffer) \
  X(VERTEXARRAYVERTEXBUFFER, glVertexArrayVertexBuffer) \
  X(VIEWPORT, glViewport)
// clang-format on

namespace sightline::gl {

#define SIGHTLINE_GL_DECLARE(TYPE, NAME) extern PFNGL##TYPE##PROC NAME;
SIGHTLINE_GL_FUNCTIONS(SIGHTLINE_GL_DECLARE)
#undef SIGHTLINE_GL_DECLARE

using Loader = void* (*)(const char* name);

/// Fills every pointer above. Throws MachineError naming the first entry point the driver lacks.
void load_functions(Loader loader);

}  // namespace sightline::gl
