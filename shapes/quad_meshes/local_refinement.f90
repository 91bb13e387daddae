module local_refinement
  !! Local refinement of unstructured splines, away from extraordinary points and up to them.
  !!
  !! The mesh is refined as a whole, level by level. On each level the functions whose supports
  !! lie in
  !! the faces to be refined are free; the control points of all others follow those of the
  !! level before by the rule of uniform refinement. What results is a subspace of the finest
  !! spline: as smooth as that, its functions sum to one since the rule's rows do, and where
  !! the rule is exact (knot insertion in C2 parts) it is the truncated hierarchical spline of
  !! Giannelli, Juettler, Speleers (CAGD 29, 2012). T-junctions of elements come without condition.
  !!
  !! Elements are the largest faces of any level on which nothing changes further down. Beside seams
  !! the rule is not exact: elements there are those of the finest level, with the functions of the
  !! coarse one where nothing is refined.
  use kinds, only: wp
  use extraction_mesh, only: extraction_mesh_type
  use quad_mesh, only: face_of, next_corner
  use sparse_row, only: row_type, clear, add_term, add_row, add_scaled_term
  use bernstein, only: bernstein_basis
  use unstructured_spline, only: unstructured_spline_type, coefficients_of, side_of_edge
  use local_dependence, only: find_combination, merge_point
  use function_colours, only: colour_functions
  use spline_refinement, only: refine_spline, follow_spline, quarter_place
  implicit none (type, external)
  private
  public :: local_spline_type, refinement_region, refine_locally, local_mesh, local_sides

  type :: level_type
    type(unstructured_spline_type) :: spline
    type(row_type), allocatable :: t(:)          !! its control points in those that are free
    logical, allocatable :: is_final(:)          !! faces on which nothing changes further down (nf)
  end type level_type

  type :: local_spline_type
    type(level_type), allocatable :: levels(:)   !! the first one is the spline to refine
    integer :: n = 0                             !! free control points
    real(wp), allocatable :: cp(:,:)             !! their places (3,n) [length]
    integer, allocatable :: level_of(:)          !! of each element (ne)
    integer, allocatable :: face(:)              !! of that level (ne)
  end type local_spline_type

  type, abstract :: refinement_region
  contains
    procedure(wanted), deferred :: wants
  end type refinement_region

  abstract interface
    pure logical function wanted(self, level, x)
      import :: refinement_region, wp
      class(refinement_region), intent(in) :: self
      integer, intent(in) :: level               !! of a face, 1: not refined yet
      real(wp), intent(in) :: x(:,:)             !! points of it (3,:) [length]
    end function wanted
  end interface

contains

  subroutine refine_locally(spline, region, most, local, message)
    type(unstructured_spline_type), intent(in) :: spline
    class(refinement_region), intent(in) :: region
    integer, intent(in) :: most                          !! levels to add at most
    type(local_spline_type), intent(out) :: local
    character(:), allocatable, intent(out) :: message    !! empty: nothing wrong

    logical, allocatable :: inside(:), parents(:)
    integer :: a, f, l

    message = ''
    allocate (local%levels(most+1))
    local%levels(1)%spline = spline
    local%n = spline%slots%n
    allocate (local%levels(1)%t(local%n))
    do a = 1, local%n
      call clear(local%levels(1)%t(a))
      call add_term(local%levels(1)%t(a), a)
    end do
    allocate (local%cp, source=spline%cp)
    allocate (inside(spline%mesh%nf), source=.true.)
    do l = 1, most
      associate (coarse => local%levels(l)%spline)
        do f = 1, coarse%mesh%nf
          if (inside(f)) inside(f) = is_wanted(coarse, f)
        end do
        if (.not. any(inside)) exit
        call refine_spline(coarse, local%levels(l+1)%spline, message)
        if (len(message) > 0) return
        call move_alloc(inside, parents)
        allocate (inside(4*size(parents)))
        do f = 1, size(inside)
          inside(f) = parents((f+3)/4)
        end do
        call join_level(local, l, inside)
      end associate
    end do
    local%levels = local%levels(1:l)
    call find_elements(local)
    call drop_unused(local)

  contains

    logical function is_wanted(coarse, f)
      type(unstructured_spline_type), intent(in) :: coarse
      integer, intent(in) :: f

      real(wp), allocatable :: b(:,:)

      call coefficients_of(coarse, f, b)
      is_wanted = region%wants(l, b)
    end function is_wanted
  end subroutine refine_locally

  subroutine join_level(local, l, inside)
    !! Which control points of level l+1 are free, and how the others follow.
    type(local_spline_type), intent(inout) :: local
    integer, intent(in) :: l
    logical, intent(in) :: inside(:)             !! faces of level l+1 that are refined ones

    type(row_type), allocatable :: r(:)
    real(wp), allocatable :: cp(:,:)
    logical, allocatable :: is_free(:)
    integer :: a, f, j, k

    call refinement_rule(local%levels(l)%spline, local%levels(l+1)%spline, r)
    associate (coarse => local%levels(l), fine => local%levels(l+1))
      allocate (is_free(fine%spline%slots%n), source=.true.)
      do f = 1, fine%spline%mesh%nf
        if (inside(f)) cycle
        do k = 1, (fine%spline%degree(f)+1)**2
          associate (row => fine%spline%b(k,f))
            is_free(row%id(1:row%n)) = .false.
          end associate
        end do
      end do
      allocate (fine%t(size(is_free)))
      allocate (cp(3,local%n+count(is_free)))
      cp(:,1:local%n) = local%cp
      do a = 1, size(is_free)
        call clear(fine%t(a))
        if (is_free(a)) then
          local%n = local%n + 1
          cp(:,local%n) = fine%spline%cp(:,a)
          call add_term(fine%t(a), local%n)
        else
          do j = 1, r(a)%n
            call add_row(fine%t(a), r(a)%c(j), coarse%t(r(a)%id(j)))
          end do
        end if
      end do
      call move_alloc(cp, local%cp)
    end associate
    call remove_dependent(local, l, r, is_free)
  end subroutine join_level

  subroutine remove_dependent(local, l, r, is_free)
    !! Control points of levels 1 ... l that beside seams act on nothing in some combination since
    !! those of level l+1 took over.
    type(local_spline_type), intent(inout) :: local
    integer, intent(in) :: l
    type(row_type), intent(in) :: r(:)           !! rule
    logical, intent(in) :: is_free(:)            !! control points of level l+1

    type(row_type) :: combination
    integer, allocatable :: candidates(:)
    logical, allocatable :: acts_inside(:), at_seam(:)
    integer :: a, f, gone, j, k, kept, m

    allocate (acts_inside(local%n), at_seam(local%n), source=.false.)
    associate (coarse => local%levels(l), fine => local%levels(l+1))
      do a = 1, size(is_free)
        if (.not. is_free(a)) cycle
        do j = 1, r(a)%n
          call mark(coarse%t(r(a)%id(j)), acts_inside)
        end do
      end do
      do f = 1, coarse%spline%mesh%nf
        if (.not. any(coarse%spline%mesh%seam(4*f-3:4*f))) cycle
        do k = 1, (coarse%spline%degree(f)+1)**2
          do j = 1, coarse%spline%b(k,f)%n
            call mark(coarse%t(coarse%spline%b(k,f)%id(j)), at_seam)
          end do
        end do
      end do
      do
        candidates = pack([(j, j = 1, size(at_seam))], acts_inside .and. at_seam)
        call find_combination(fine%t, .not. is_free, candidates, combination)
        if (combination%n < 2) exit
        call merge_point(combination, candidates, local%cp, gone, kept)
        acts_inside(gone) = .false.
        do m = 1, l + 1
          do a = 1, size(local%levels(m)%t)
            call replace(local%levels(m)%t(a), gone, kept)
          end do
        end do
      end do
    end associate

  contains

    subroutine mark(row, marks)
      type(row_type), intent(in) :: row
      logical, intent(inout) :: marks(:)

      marks(row%id(1:row%n)) = .true.
    end subroutine mark

    subroutine replace(row, gone, kept)
      type(row_type), intent(inout) :: row
      integer, intent(in) :: gone, kept          !! control points

      real(wp) :: factor
      integer :: place

      place = findloc(row%id(1:row%n), gone, 1)
      if (place == 0) return
      factor = row%c(place)
      row%id(place) = row%id(row%n)
      row%c(place) = row%c(row%n)
      row%n = row%n - 1
      call add_scaled_term(row, factor, kept)
    end subroutine replace
  end subroutine remove_dependent

  subroutine refinement_rule(coarse, fine, rule)
    !! The control points of the refinement as combinations of those of the spline: probing of the
    !! linear map, all control points at once that have no common neighbourhood. The three
    !! coordinates carry 1, j, j**2, so that the factor and the number j of the one that acts are
    !! known, and that it is one.
    type(unstructured_spline_type), intent(in) :: coarse, fine
    type(row_type), allocatable, intent(out) :: rule(:)

    real(wp), parameter :: rounding = 1e-11_wp
    type(unstructured_spline_type) :: probe, answer
    integer, allocatable :: colour(:)
    real(wp) :: tag
    integer :: a, j, n, round

    allocate (rule(fine%slots%n))
    do a = 1, size(rule)
      call clear(rule(a))
    end do
    call colour_functions(coarse, colour)
    probe = coarse
    answer = fine
    n = coarse%slots%n
    do round = 1, maxval(colour)
      probe%cp = 0
      do j = 1, n
        tag = real(j, wp)/n
        if (colour(j) == round) probe%cp(:,j) = [1.0_wp, tag, tag**2]
      end do
      call follow_spline(probe, answer)
      do a = 1, size(rule)
        associate (x => answer%cp(:,a))
          if (maxval(abs(x)) < rounding) cycle
          if (abs(x(1)) < rounding) error stop 'local_refinement: two control points act on one'
          j = nint(x(2)/x(1)*n)
          tag = real(j, wp)/n
          if (j < 1 .or. j > n .or. abs(x(3) - x(1)*tag**2) > 1e-3_wp*abs(x(1))/n .and. &
            abs(x(1)) > 1e-6_wp) error stop 'local_refinement: two control points act on one'
          call add_scaled_term(rule(a), x(1), j)
        end associate
      end do
    end do
  end subroutine refinement_rule

  subroutine find_elements(local)
    !! By free control points at random: faces whose quarters show the same surface.
    type(local_spline_type), intent(inout) :: local

    type(unstructured_spline_type), allocatable :: shown(:)
    real(wp), allocatable :: at_random(:,:)
    integer :: a, f, i, l, last
    logical :: same

    last = size(local%levels)
    allocate (at_random(3,local%n), shown(last))
    do a = 1, local%n
      at_random(:,a) = [(sin(1.7_wp*a + 0.3_wp*i) + cos(0.9_wp*a*i), i = 1, 3)]
    end do
    do l = 1, last
      shown(l) = local%levels(l)%spline
      call set_free(local%levels(l)%t, at_random, shown(l)%cp)
    end do
    do l = last, 1, -1
      associate (level => local%levels(l))
        allocate (level%is_final(level%spline%mesh%nf), source=.true.)
        if (l == last) cycle
        do f = 1, level%spline%mesh%nf
          same = all(local%levels(l+1)%is_final(4*f-3:4*f))
          if (same) same = shows_the_same(shown(l), shown(l+1), f)
          level%is_final(f) = same
        end do
      end associate
    end do
    allocate (local%level_of(0), local%face(0))
    do f = 1, local%levels(1)%spline%mesh%nf
      call collect(1, f)
    end do

  contains

    recursive subroutine collect(l, f)
      integer, intent(in) :: l, f

      integer :: k

      if (local%levels(l)%is_final(f)) then
        local%level_of = [local%level_of, l]
        local%face = [local%face, f]
      else
        do k = 4*f - 3, 4*f
          call collect(l + 1, k)
        end do
      end if
    end subroutine collect
  end subroutine find_elements

  pure subroutine set_free(t, free, cp)
    type(row_type), intent(in) :: t(:)
    real(wp), intent(in) :: free(:,:)            !! free control points (3,n)
    real(wp), intent(out) :: cp(:,:)             !! those of a level

    integer :: a, j

    do a = 1, size(t)
      cp(:,a) = 0
      do j = 1, t(a)%n
        cp(:,a) = cp(:,a) + t(a)%c(j)*free(:,t(a)%id(j))
      end do
    end do
  end subroutine set_free

  logical function shows_the_same(coarse, fine, f) result(same)
    type(unstructured_spline_type), intent(in) :: coarse, fine
    integer, intent(in) :: f                     !! face of the coarse spline

    real(wp), parameter :: places(4) = [0.0_wp, 0.3_wp, 0.6_wp, 1.0_wp], rounding = 1e-11_wp
    real(wp), allocatable :: b(:,:), b_fine(:,:)
    real(wp) :: xi(2)
    integer :: i, j, k

    same = .false.
    call coefficients_of(coarse, f, b)
    do k = 0, 3
      ! the quarter at this corner
      call coefficients_of(fine, 4*f - 3 + k, b_fine)
      do j = 1, 4
        do i = 1, 4
          xi = [places(i), places(j)]
          if (maxval(abs(place_of(b, quarter_place(k, xi)) - place_of(b_fine, xi))) > rounding) &
            return
        end do
      end do
    end do
    same = .true.
  end function shows_the_same

  pure function place_of(b, xi) result(x)
    real(wp), intent(in) :: b(:,:)               !! Bezier coefficients (3,(p+1)**2)
    real(wp), intent(in) :: xi(2)
    real(wp) :: x(3)

    real(wp) :: bez(size(b, 2)), dbez(2,size(b, 2)), d2bez(3,size(b, 2))
    integer :: p

    p = nint(sqrt(real(size(b, 2), wp))) - 1
    call bernstein_basis([p, p], xi, 0, bez, dbez, d2bez)
    x = matmul(b, bez)
  end function place_of

  subroutine element_row(local, e, k, row)
    !! Bezier coefficient k of an element in free control points.
    type(local_spline_type), intent(in) :: local
    integer, intent(in) :: e, k
    type(row_type), intent(inout) :: row

    integer :: j

    call clear(row)
    associate (level => local%levels(local%level_of(e)))
      associate (b => level%spline%b(k,local%face(e)))
        do j = 1, b%n
          call add_row(row, b%c(j), level%t(b%id(j)))
        end do
      end associate
    end associate
  end subroutine element_row

  subroutine drop_unused(local)
    !! Control points that no element uses any more.
    type(local_spline_type), intent(inout) :: local

    type(row_type) :: row
    logical, allocatable :: used(:)
    integer, allocatable :: new(:)
    real(wp), allocatable :: cp(:,:)
    integer :: a, e, k, l

    allocate (used(local%n), source=.false.)
    do e = 1, size(local%face)
      do k = 1, (degree_of(local, e) + 1)**2
        call element_row(local, e, k, row)
        do a = 1, row%n
          if (abs(row%c(a)) > 1e-12_wp) used(row%id(a)) = .true.
        end do
      end do
    end do
    allocate (new(local%n), source=0)
    allocate (cp(3,count(used)))
    l = 0
    do a = 1, local%n
      if (.not. used(a)) cycle
      l = l + 1
      new(a) = l
      cp(:,l) = local%cp(:,a)
    end do
    local%n = l
    call move_alloc(cp, local%cp)
    do l = 1, size(local%levels)
      do a = 1, size(local%levels(l)%t)
        call renumber(local%levels(l)%t(a))
      end do
    end do

  contains

    subroutine renumber(t)
      type(row_type), intent(inout) :: t

      integer :: j, m

      m = 0
      do j = 1, t%n
        if (new(t%id(j)) == 0) cycle
        m = m + 1
        t%id(m) = new(t%id(j))
        t%c(m) = t%c(j)
      end do
      t%n = m
    end subroutine renumber
  end subroutine drop_unused

  pure integer function degree_of(local, e)
    type(local_spline_type), intent(in) :: local
    integer, intent(in) :: e

    degree_of = local%levels(local%level_of(e))%spline%degree(local%face(e))
  end function degree_of

  subroutine local_mesh(local, mesh)
    !! Free control points and elements; no sets.
    type(local_spline_type), intent(in) :: local
    type(extraction_mesh_type), intent(inout) :: mesh

    real(wp), parameter :: rounding = 1e-14_wp
    type(row_type) :: all_points
    type(row_type), allocatable :: rows(:)
    real(wp), allocatable :: ce(:,:)
    integer :: a, e, k, j, nb

    call mesh%start('')
    do a = 1, local%n
      call mesh%add_node(local%cp(:,a), 1.0_wp, 0)
    end do
    do e = 1, size(local%face)
      nb = (degree_of(local, e) + 1)**2
      allocate (rows(nb))
      call clear(all_points)
      do k = 1, nb
        call element_row(local, e, k, rows(k))
        do j = 1, rows(k)%n
          if (abs(rows(k)%c(j)) > rounding) call add_term(all_points, rows(k)%id(j))
        end do
      end do
      allocate (ce(all_points%n,nb), source=0.0_wp)
      do k = 1, nb
        do j = 1, rows(k)%n
          if (abs(rows(k)%c(j)) > rounding) &
            ce(findloc(all_points%id(1:all_points%n), rows(k)%id(j), dim=1),k) = rows(k)%c(j)
        end do
      end do
      call mesh%add_element(spread(degree_of(local, e), 1, 2), all_points%id(1:all_points%n), ce, 0)
      deallocate (rows, ce)
    end do
    call mesh%finish()
  end subroutine local_mesh

  subroutine local_sides(local, corner, elements, sides)
    !! The elements and their sides that lie on an edge of the first level.
    type(local_spline_type), intent(in) :: local
    integer, intent(in) :: corner                       !! that the edge starts from
    integer, allocatable, intent(out) :: elements(:)    !! in the direction of the edge
    integer, allocatable, intent(out) :: sides(:)       !! 1: s=0, 2: s=1, 3: t=0, 4: t=1

    allocate (elements(0), sides(0))
    call follow(1, corner)

  contains

    recursive subroutine follow(l, c)
      integer, intent(in) :: l, c

      integer :: e, next

      if (local%levels(l)%is_final(face_of(c))) then
        do e = 1, size(local%face)
          if (local%level_of(e) == l .and. local%face(e) == face_of(c)) exit
        end do
        elements = [elements, e]
        sides = [sides, side_of_edge(c)]
      else
        ! the quarter at the start begins with this edge, that at the end ends with it
        next = next_corner(c)
        call follow(l + 1, 4*c - 3)
        call follow(l + 1, 4*next)
      end if
    end subroutine follow
  end subroutine local_sides
end module local_refinement
