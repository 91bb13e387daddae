module facets
  !! Facets of the surface sets of a model.
  use surface_facets, only: facet_surface, build_surface_facets
  use model_data, only: model_type
  implicit none (type, external)
  private
  public :: facet_surface, build_facets

contains

  subroutine build_facets(model, set, surface)
    !! Facets of a surface set, in its order.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: set                   !! index into model%sets
    type(facet_surface), intent(out) :: surface

    call build_surface_facets(model%mesh, model%sets(set)%items, model%sets(set)%sides, surface)
  end subroutine build_facets
end module facets
