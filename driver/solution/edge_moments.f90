module edge_moments
  !! Moments on the edges of shells (SLOAd edge MOMEnt m): their points, and what they add to forces and tangent in every
  !! assembly, since they follow the edge.
  use kinds, only: wp
  use status_codes, only: ok
  use model_data, only: model_type, surface_load_type
  use gauss_rules, only: gauss_legendre
  use rational_basis, only: shape_functions
  use side_extraction, only: side_parameters
  use edge_moment, only: edge_moment_force
  use bulk_elements, only: add_moved_force
  use equation_system, only: equation_system_type
  implicit none (type, external)
  private
  public :: edge_moment_type, prepare_edge_moment, add_edge_moment

  type :: edge_part
    !! One element at the edge.
    integer :: element = 0, side = 0
    real(wp), allocatable :: dshp(:, :, :)   !! R_,1 and R_,2 at the points (2,nen,ng)
    real(wp), allocatable :: length(:)       !! of the points (ng) [length]
  end type edge_part

  type :: edge_moment_type
    type(edge_part), allocatable :: parts(:)
    real(wp) :: moment = 0                   !! per length, at factor 1 [force]
    integer :: prop = 0
  end type edge_moment_type

contains

  subroutine prepare_edge_moment(model, load, edge)
    type(model_type), intent(in), target :: model
    type(surface_load_type), intent(in) :: load
    type(edge_moment_type), intent(out) :: edge
    integer, pointer, contiguous :: ix(:)
    real(wp), allocatable :: eta(:), wt(:), shp(:)
    real(wp) :: xi(2), unused(0, 0), tau(3)
    integer :: e, g, i, n, along, status

    edge%moment = load%value(1)
    edge%prop = load%prop
    associate (set => model%sets(load%set))
      allocate (edge%parts(size(set%items)))
      do i = 1, size(set%items)
        e = set%items(i)
        along = 3 - (set%sides(i) + 1)/2
        ix => model%mesh%connectivity(e)
        n = model%mesh%degree(along, e) + 1
        if (load%gp > 0) n = load%gp
        eta = [(0.0_wp, g=1, n)]
        wt = eta
        call gauss_legendre(n, eta, wt)
        shp = [(0.0_wp, g=1, size(ix))]
        edge%parts(i)%element = e
        edge%parts(i)%side = set%sides(i)
        allocate (edge%parts(i)%dshp(2, size(ix), n), edge%parts(i)%length(n))
        do g = 1, n
          call side_parameters(set%sides(i), eta(g:g), xi)
          call shape_functions(model%mesh%degree(1:2, e), model%w(ix), model%mesh%operator(e), xi, 1, shp, &
            edge%parts(i)%dshp(:, :, g), unused, status)
          tau = matmul(model%x(:, ix), edge%parts(i)%dshp(along, :, g))
          edge%parts(i)%length(g) = wt(g)*norm2(tau)
        end do
      end do
    end associate
  end subroutine prepare_edge_moment

  subroutine add_edge_moment(model, edge, factor, u, fext, status, du, moves, system, f_moved)
    !! fext := fext + the load; with a system its tangent too.
    type(model_type), intent(in) :: model
    type(edge_moment_type), intent(in) :: edge
    real(wp), intent(in) :: factor                             !! of the time function
    real(wp), intent(in) :: u(:, :)                            !! control values (ndf,nn)
    real(wp), intent(inout) :: fext(:, :)                      !! (ndf,nn)
    integer, intent(out) :: status
    real(wp), intent(in), optional :: du(:, :)                 !! prescribed increments or rates
    logical, intent(in), optional :: moves(:)                  !! (nn) where they are not zero; size 0: nowhere
    type(equation_system_type), intent(inout), optional :: system
    real(wp), intent(inout), optional :: f_moved(:, :)         !! change of internal forces by du
    integer, pointer, contiguous :: ix(:)
    real(wp), allocatable :: fe(:, :), ke(:, :, :, :)
    integer :: i

    status = ok
    do i = 1, size(edge%parts)
      associate (part => edge%parts(i))
        ix => model%mesh%connectivity(part%element)
        allocate (fe(3, size(ix)), ke(3, size(ix), 3, size(ix)))
        call edge_moment_force(part%side, model%x(:, ix), u(1:3, ix), part%dshp, part%length, factor*edge%moment, fe, ke, &
          status)
        if (status /= ok) return
        fext(1:3, ix) = fext(1:3, ix) - fe
        if (present(system)) then
          if (size(moves) > 0) then
            if (any(moves(ix))) call add_moved_force(ke, du, ix, .false., f_moved)
          end if
          call system%add_loose(ix, ke, .false.)
        end if
        deallocate (fe, ke)
      end associate
    end do
  end subroutine add_edge_moment
end module edge_moments
