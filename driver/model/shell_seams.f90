module shell_seams
  !! Sides that two shell elements share, and what a shell cannot take there:
  !!
  !!   flipped      their normals point to opposite sides
  !!   kinked       the surface has an angle there
  !!   hinged       the functions have no common derivative across: dR_a/dnu of both sides (outward conormals) must add
  !!                up to zero for each function, else the slopes of both sides are independent
  !!
  !! Two sides are one if the same functions live on them; at T-junctions, where they are not, nothing is compared.
  use kinds, only: wp
  use status_codes, only: ok
  use model_data, only: model_type
  use surface_facets, only: facet_surface, build_surface_facets
  use edge_rows, only: edge_point, edge_point_at
  implicit none (type, external)
  private
  public :: shell_seam, find_seams, other_parameter

  type :: shell_seam
    !! A common side that is not smooth.
    integer :: element(2) = 0, side(2) = 0
    logical :: turned = .false.      !! the second side runs in the same direction as the first
    logical :: flipped = .false., kinked = .false., hinged = .false.
    real(wp) :: x(3) = 0             !! its middle [length]
  end type shell_seam

  real(wp), parameter :: same_place = 1e-7_wp      !! relative to the model's size
  real(wp), parameter :: same_slope = 1e-6_wp      !! relative to the largest derivative; sine of an angle

contains

  subroutine find_seams(model, seams)
    type(model_type), intent(in), target :: model
    type(shell_seam), allocatable, intent(out) :: seams(:)
    type(facet_surface) :: surface
    type(shell_seam) :: seam
    type(shell_seam), allocatable :: larger(:)
    integer, allocatable :: shells(:)
    integer :: e, f, n, other, s
    real(wp) :: extent

    allocate (seams(64))
    n = 0
    shells = pack([(e, e=1, model%mesh%ne)], [(needs_slopes(model, e), e=1, model%mesh%ne)])
    if (size(shells) > 0) then
      extent = maxval(abs(model%x))
      call build_surface_facets(model%mesh, shells, 0*shells, surface)
      do f = 1, size(shells)
        do s = 1, 4
          other = surface%neighbour(s, f)
          if (other <= f) cycle
          call compare_sides(model, shells(f), s, shells(other), extent, seam)
          if (.not. (seam%flipped .or. seam%kinked .or. seam%hinged)) cycle
          if (n == size(seams)) then
            allocate (larger(2*n))
            larger(1:n) = seams
            call move_alloc(larger, seams)
          end if
          n = n + 1
          seams(n) = seam
        end do
      end do
    end if
    seams = seams(1:n)
  end subroutine find_seams

  logical function needs_slopes(model, e)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e

    needs_slopes = .false.
    if (model%mesh%dp(e) /= 2 .or. model%ndm /= 3) return
    if (model%material_of(e) == 0) return
    if (.not. allocated(model%materials(model%material_of(e))%element)) return
    needs_slopes = model%materials(model%material_of(e))%element%smoothness > 0
  end function needs_slopes

  subroutine compare_sides(model, e, s, other, extent, seam)
    type(model_type), intent(in), target :: model
    integer, intent(in) :: e, s, other
    real(wp), intent(in) :: extent               !! size of the model
    type(shell_seam), intent(out) :: seam
    type(edge_point) :: here, there
    real(wp), parameter :: eta(3) = [0.5_wp, 0.1_wp, 0.8_wp]
    integer, pointer, contiguous :: ia(:), ib(:)
    real(wp) :: largest, sum_of_both
    integer :: a, b, i, k, s2, status

    ia => model%mesh%connectivity(e)
    ib => model%mesh%connectivity(other)
    ! which side it is, and how it runs
    call edge_point_at(model, e, s, eta(3), there, status)
    if (status == ok) call edge_point_at(model, e, s, eta(2), here, status)
    if (status /= ok) return
    if (norm2(here%x - there%x) <= same_place*extent) return      ! a pole is no seam
    seam%element = [e, other]
    seam%side = [s, 0]
    sides: do i = 0, 3
      s2 = ieor(s - 1 + i, 1)              ! in a grid it is the opposite one
      s2 = 1 + mod(s2, 4)
      do k = 1, 2
        call edge_point_at(model, other, s2, merge(1 - eta(2), eta(2), k == 1), there, status)
        if (status /= ok) cycle
        if (norm2(here%x - there%x) > same_place*extent) cycle
        seam%side(2) = s2
        seam%turned = k == 2
        exit sides
      end do
    end do sides
    if (seam%side(2) == 0) return
    do k = 1, 3
      call edge_point_at(model, e, s, eta(k), here, status)
      if (status == ok) call edge_point_at(model, other, seam%side(2), other_parameter(seam, eta(k)), there, status)
      if (status /= ok) cycle
      if (k == 1) seam%x = here%x
      ! normals of sides that run alike point to opposite sides
      if (dot_product(here%nu, there%nu) < 0 .and. dot_product(here%nrm, there%nrm) < 0) seam%flipped = .true.
      if (seam%turned) seam%flipped = .true.
      if (norm2(here%nu + there%nu) > same_slope) seam%kinked = .true.
      largest = max(maxval(abs(here%dnu)), maxval(abs(there%dnu)))
      do a = 1, size(ia)
        sum_of_both = here%dnu(a)
        do b = 1, size(ib)
          if (ib(b) == ia(a)) sum_of_both = sum_of_both + there%dnu(b)
        end do
        if (abs(sum_of_both) > same_slope*largest) seam%hinged = .true.
      end do
      do b = 1, size(ib)
        if (any(ia == ib(b))) cycle
        if (abs(there%dnu(b)) > same_slope*largest) seam%hinged = .true.
      end do
    end do
  end subroutine compare_sides

  pure real(wp) function other_parameter(seam, eta)
    !! Parameter on the second side of the point at eta of the first.
    type(shell_seam), intent(in) :: seam
    real(wp), intent(in) :: eta

    other_parameter = merge(eta, 1 - eta, seam%turned)
  end function other_parameter
end module shell_seams
