#ifndef RENDER_GLES_FUNCTIONS_H
#define RENDER_GLES_FUNCTIONS_H
/* The functions of EGL and OpenGL ES that are used here, found when the program runs: no program needs libEGL or libGLESv2 to
 * start. gl->DrawArrays(...) is glDrawArrays; to use another one is to add its name. Calling glDrawArrays itself compiles, but
 * does not link. The libraries stay loaded until the process ends: drivers do not like to leave. */
#define EGL_EGLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl31.h>
/* Behind it, for it takes types of it. */
#include <GLES2/gl2ext.h>
#include <glib.h>
#include <stdbool.h>

/* clang-format off */
#define EGL_FUNCTIONS(X) \
	X(BindAPI) X(ChooseConfig) X(CreateContext) X(DestroyContext) \
	X(GetCurrentContext) X(GetError) X(GetProcAddress) X(Initialize) X(MakeCurrent) X(QueryString)
/* EGL_EXT_platform_base, EGL_EXT_device_enumeration: only there where the extension is. */
#define EGL_OPTIONAL(X) \
	X(GetPlatformDisplayEXT) X(QueryDevicesEXT)
#define GLES_FUNCTIONS(X) \
	X(ActiveTexture) X(AttachShader) X(BeginQuery) X(BindBuffer) X(BindBufferBase) \
	X(BindBufferRange) X(BindFramebuffer) X(BindImageTexture) X(BindRenderbuffer) \
	X(BindSampler) X(BindTexture) X(BindVertexArray) X(BlendColor) X(BlendEquation) \
	X(BlendEquationSeparate) X(BlendFunc) X(BlendFuncSeparate) X(BlitFramebuffer) \
	X(BufferData) X(BufferSubData) X(CheckFramebufferStatus) X(Clear) X(ClearBufferfi) \
	X(ClearBufferfv) X(ClearBufferiv) X(ClearBufferuiv) X(ClearColor) X(ClearDepthf) \
	X(ClientWaitSync) X(ColorMask) X(CompileShader) X(CopyBufferSubData) \
	X(CopyTexSubImage2D) X(CreateProgram) X(CreateShader) X(CullFace) X(DeleteBuffers) \
	X(DeleteFramebuffers) X(DeleteProgram) X(DeleteQueries) X(DeleteRenderbuffers) \
	X(DeleteSamplers) X(DeleteShader) X(DeleteSync) X(DeleteTextures) \
	X(DeleteVertexArrays) X(DepthFunc) X(DepthMask) X(DepthRangef) X(DetachShader) \
	X(Disable) X(DisableVertexAttribArray) X(DispatchCompute) X(DispatchComputeIndirect) \
	X(DrawArrays) X(DrawArraysIndirect) X(DrawArraysInstanced) X(DrawBuffers) \
	X(DrawElements) X(DrawElementsIndirect) X(DrawElementsInstanced) X(Enable) \
	X(EnableVertexAttribArray) X(EndQuery) X(FenceSync) X(Finish) X(Flush) \
	X(FlushMappedBufferRange) X(FramebufferRenderbuffer) X(FramebufferTexture2D) \
	X(FramebufferTextureLayer) X(GenBuffers) X(GenFramebuffers) X(GenQueries) \
	X(GenRenderbuffers) X(GenSamplers) X(GenTextures) X(GenVertexArrays) \
	X(GenerateMipmap) X(GetError) X(GetFloatv) X(GetInteger64v) X(GetIntegeri_v) \
	X(GetIntegerv) X(GetProgramBinary) X(GetProgramInfoLog) X(GetProgramInterfaceiv) \
	X(GetProgramResourceIndex) X(GetProgramResourceName) X(GetProgramResourceiv) \
	X(GetProgramiv) X(GetQueryObjectuiv) X(GetShaderInfoLog) X(GetShaderiv) X(GetString) \
	X(GetStringi) X(GetSynciv) X(GetUniformBlockIndex) X(GetUniformLocation) \
	X(InvalidateFramebuffer) X(LinkProgram) X(MapBufferRange) X(MemoryBarrier) \
	X(MemoryBarrierByRegion) X(PixelStorei) X(PolygonOffset) X(ProgramBinary) \
	X(ReadBuffer) X(ReadPixels) X(RenderbufferStorage) X(SamplerParameterf) \
	X(SamplerParameteri) X(Scissor) X(ShaderSource) X(StencilFunc) X(StencilMask) \
	X(StencilOp) X(TexImage2D) X(TexParameterf) X(TexParameteri) X(TexStorage2D) \
	X(TexStorage3D) X(TexSubImage2D) X(TexSubImage3D) X(Uniform1f) X(Uniform1fv) \
	X(Uniform1i) X(Uniform1iv) X(Uniform1ui) X(Uniform1uiv) X(Uniform2f) X(Uniform2fv) \
	X(Uniform2i) X(Uniform2iv) X(Uniform2ui) X(Uniform3f) X(Uniform3fv) X(Uniform3i) \
	X(Uniform3ui) X(Uniform4f) X(Uniform4fv) X(Uniform4i) X(Uniform4iv) X(Uniform4ui) \
	X(UniformBlockBinding) X(UniformMatrix3fv) X(UniformMatrix4fv) X(UnmapBuffer) \
	X(UseProgram) X(ValidateProgram) X(VertexAttrib4f) X(VertexAttribDivisor) \
	X(VertexAttribIPointer) X(VertexAttribPointer) X(Viewport)
/* With the extension that they belong to; NULL where it is not. */
#define GLES_OPTIONAL(X) \
	X(GL_KHR_debug, DebugMessageCallbackKHR) X(GL_KHR_debug, DebugMessageControlKHR) \
	X(GL_KHR_robustness, GetGraphicsResetStatusKHR) \
	X(GL_EXT_robustness, GetGraphicsResetStatusEXT) \
	X(GL_EXT_buffer_storage, BufferStorageEXT) \
	X(GL_EXT_disjoint_timer_query, QueryCounterEXT) \
	X(GL_EXT_disjoint_timer_query, GetQueryObjectui64vEXT)
/* clang-format on */

#define EGL_MEMBER(name)                  __typeof__(egl##name) *name;
#define GLES_MEMBER(name)                 __typeof__(gl##name) *name;
#define GLES_OPTIONAL_MEMBER(needs, name) GLES_MEMBER(name)

struct egl_functions {
	EGL_FUNCTIONS(EGL_MEMBER)
	EGL_OPTIONAL(EGL_MEMBER)
};
struct gles_functions {
	GLES_FUNCTIONS(GLES_MEMBER)
	GLES_OPTIONAL(GLES_OPTIONAL_MEMBER)
};

/* Loads libEGL.so.1 at the first call; any thread. NULL: "there is no libEGL.so.1 on this machine", or why it is of no use. */
const struct egl_functions *egl_functions_load(GError **error);
/* "EGL_BAD_ALLOC", of the last call; not to be freed. */
const char *egl_error_name(const struct egl_functions *egl);

/* Those of the context that is current. From eglGetProcAddress, and where it does not know one, from libGLESv2.so.2. */
bool gles_functions_load(
	const struct egl_functions *egl, struct gles_functions *ret, GError **error);
bool gles_has_extension(const struct gles_functions *gl, const char *name);

/* Whether a list separated by blanks has this word. NULL has none. */
bool gles_list_has(const char *list, const char *word);

#endif
