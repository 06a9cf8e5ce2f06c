//! Structures that will grow are begun from their default, and given field by field.

/// Methods named as the fields, that give the structure with another value of one: a program that sets some of them goes on
/// compiling when one is added.
macro_rules! setters {
    ($structure:ident { $( $name:ident: $type:ty, )* }) => {
        impl $structure {
            $(
                #[doc = concat!("The same with another [`", stringify!($name), "`](Self#structfield.", stringify!($name), ").")]
                #[must_use]
                pub fn $name(mut self, $name: $type) -> Self {
                    self.$name = $name.into();
                    self
                }
            )*
        }
    };
}
pub(crate) use setters;
