//! Texture formats, by their names in wgpu.

macro_rules! formats {
    ($($name:ident)*) => {
        /// Names of the texture formats that a document can name.
        pub(crate) const FORMATS: &[&str] = &[$(stringify!($name)),*];

        /// Returns the texture format called `name`; `None` if there is no such format.
        pub(crate) fn format_named(name: &str) -> Option<wgt::TextureFormat> {
            match name {
                $(stringify!($name) => Some(wgt::TextureFormat::$name),)*
                _ => None,
            }
        }
    };
}

formats! {
    R8Unorm R8Snorm R8Uint R8Sint R16Uint R16Sint R16Float Rg8Unorm Rg8Snorm Rg8Uint Rg8Sint
    R32Uint R32Sint R32Float Rg16Uint Rg16Sint Rg16Float Rgba8Unorm Rgba8UnormSrgb Rgba8Snorm
    Rgba8Uint Rgba8Sint Bgra8Unorm Bgra8UnormSrgb Rgb10a2Unorm Rgb10a2Uint Rg11b10Ufloat Rg32Uint
    Rg32Sint Rg32Float Rgba16Uint Rgba16Sint Rgba16Float Rgba32Uint Rgba32Sint Rgba32Float
    R16Unorm R16Snorm Rg16Unorm Rg16Snorm Rgba16Unorm Rgba16Snorm
    Stencil8 Depth16Unorm Depth24Plus Depth24PlusStencil8 Depth32Float Depth32FloatStencil8
}
